"""Removes the name of a forgotten person from the texts of clips and from lists of imported files.

In the clips of the person, the name is replaced wherever it is. In the clips of others, a word that
equals the name is removed, and a folder of the path or a part of the source that equals it is
replaced: no other text, because a name can be a common word too, and the person "Max" is not in
`max_speed.bvh`. In lists of imported files, in the names and notes of collections, and in saved
searches, a name with a letter is replaced wherever it is; a search for the person is removed.
Metadata and captions that hold the name are removed from all clips; a name without a letter, only
from those of the person, and where the whole value equals it. The same holds for the sentences of
annotations; who moves in them or made them is removed where it equals the name.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import Any

from app.services.clips.anonymize import NameRemover
from app.store import collections, label_parents, saved_searches
from app.store.clips import clip_annotations, texts
from app.store.clips.clip_annotations import Annotation
from app.store.clips.metadata_values import as_text
from app.store.clips.record import META
from app.store.clips.texts import ClipTexts
from app.store.database.engine import Tx
from app.store.jobs import import_texts


def remove_name(tx: Tx, person: str, clip_ids: Collection[str]) -> None:
    """Remove the name of a person; clip_ids: the clips that had the person's label."""
    remover, own = NameRemover(person), frozenset(clip_ids)
    cleaned = ((clip, _cleaned(remover, clip, clip.id in own)) for clip in texts.read(tx))
    texts.write(tx, [(before, now) for before, now in cleaned if before != now])
    said = [(one, _unnamed(remover, one, one.clip_id in own)) for one in clip_annotations.every(tx)]
    clip_annotations.rewrite(tx, [now for before, now in said if before != now])

    def in_import(clip_id: str | None, value: Any) -> Any:
        return remover.in_json(value) if remover.has_letter or clip_id in own else value

    import_texts.rewrite(tx, in_import)
    if remover.has_letter:
        _remove_from_collections(tx, remover)
        _remove_from_searches(tx, remover)
        _remove_from_tree(tx, remover)


def _remove_from_collections(tx: Tx, remover: NameRemover) -> None:
    for row_id, name, notes in list(collections.texts(tx)):
        if remover.holds_name(name) or remover.holds_name(notes):
            collections.rewrite(tx, row_id, remover.without(name), remover.without(notes))


def _remove_from_searches(tx: Tx, remover: NameRemover) -> None:
    for search in saved_searches.every(tx):
        if any(map(remover.is_name, _strings(search.query))):
            saved_searches.remove(tx, search.id)
            continue
        name, query = remover.without(search.name), remover.in_json(search.query)
        if (name, query) != (search.name, search.query):
            saved_searches.rewrite(tx, search.id, name, query)


def _remove_from_tree(tx: Tx, remover: NameRemover) -> None:
    said = label_parents.read(tx)
    named = {label for label in {*said, *said.values()} if label and remover.is_name(label)}
    label_parents.remove(tx, named)


def _strings(value: Any) -> Iterator[str]:
    """All strings in a value of JSON, apart from the keys of objects."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for one in value.values() if isinstance(value, dict) else value:
            yield from _strings(one)


def _cleaned(remover: NameRemover, clip: ClipTexts, is_own: bool) -> ClipTexts:
    metadata = {
        key: value
        for key, value in clip.metadata.items()
        if not _is_named(remover, as_text(value), is_own)
    }
    words = tuple(word for word in clip.words if not remover.is_name(word))
    captions = tuple(text for text in clip.captions if not _is_named(remover, text, is_own))
    imported = {
        name: value
        for name, value in clip.imported.items()
        if not _names_person(remover, name, value, is_own)
    }
    changed = replace(clip, metadata=metadata, captions=captions, words=words, imported=imported)
    if is_own:
        return replace(
            changed,
            name=remover.without(clip.name),
            file_name=remover.without(clip.file_name),
            path=None if clip.path is None else remover.without(clip.path),
            source=None if clip.source is None else remover.without(clip.source),
            audio_name=None if clip.audio_name is None else remover.without(clip.audio_name),
        )
    return replace(
        changed,
        path=None if clip.path is None else remover.without_parts(clip.path),
        source=None if clip.source is None else remover.without_parts(clip.source),
    )


def _unnamed(remover: NameRemover, one: Annotation, is_own: bool) -> Annotation:
    """An annotation without the name."""
    is_his = is_own or (one.person is not None and remover.is_name(one.person))
    return replace(
        one,
        words=tuple(word for word in one.words if not remover.is_name(word)),
        person=None if one.person and remover.is_name(one.person) else one.person,
        text=None if one.text and _is_named(remover, one.text, is_his) else one.text,
        by=None if one.by and remover.is_name(one.by) else one.by,
    )


def _is_named(remover: NameRemover, text: str, is_own: bool) -> bool:
    """Whether a value of the metadata names the person."""
    if remover.has_letter or is_own:
        return remover.holds_name(text)
    return remover.is_name(text)


def _names_person(remover: NameRemover, field: str, value: Any, is_own: bool) -> bool:
    """Whether a label or hint that came with the file names the person."""
    if field == "person":
        return isinstance(value, str) and remover.is_name(value)
    if field == "captions" and value is not None:
        return any(_is_named(remover, text, is_own) for text in value)
    if isinstance(value, list):
        return any(isinstance(one, str) and remover.is_name(one) for one in value)
    if field.startswith(META) and value is not None:
        return _is_named(remover, as_text(value), is_own)
    return isinstance(value, str) and _is_named(remover, value, is_own)
