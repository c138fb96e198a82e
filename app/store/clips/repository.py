"""Clips: adding, reading, changing, removing. `listing` lists them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from sqlalchemy import RowMapping, bindparam, delete, insert, select, update

from app.errors import ClipNotFound
from app.kinedex_error import Place
from app.store.clips import clip_captions, clip_metadata, visibility
from app.store.clips import versions as library
from app.store.clips.record import (
    AUDIO_HINTS,
    AddOutcome,
    AddResult,
    AnalysisInput,
    ClipChanges,
    ClipFacts,
    ClipRecord,
    ClipState,
    ClipWarning,
    NewClip,
    Reanalysis,
)
from app.store.clips.rows import (
    INPUT_COLUMNS,
    changed_input,
    changed_metadata,
    client_fields,
    input_of,
    origin_columns,
    searched_text,
    to_columns,
    to_record,
)
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.tables import clip_words, clips
from app.store.database.text_list import as_list, is_one_of

_SEARCHED = frozenset({"name", "path", "metadata", "captions"})
"""The fields that `rows.searched_text` takes."""
IDS_PER_QUERY = 500
"""A limit, because databases limit the number of parameters of one statement."""

# Built once, because to build a statement takes longer than to execute it.
_SOME = select(clips).where(is_one_of(clips.c.id, "ids"))
_STATE = select(clips.c.state).where(clips.c.id == bindparam("the_id"))
_INPUT = select(*(clips.c[name] for name in INPUT_COLUMNS)).where(clips.c.id == bindparam("the_id"))
_VERSION = select(clips.c.changed_version).where(
    clips.c.id == bindparam("the_id"), clips.c.state == ClipState.READY.value
)
_WITH_CONTENT = select(clips.c.id).where(clips.c.content_key == bindparam("content"))
_CHANGE = update(clips).where(clips.c.id == bindparam("the_id"))
_BEGIN = (
    update(clips)
    .where(clips.c.id == bindparam("the_id"), clips.c.state == ClipState.QUEUED.value)
    .values(state=ClipState.PROCESSING.value)
)
_ADD, _ADD_WORDS = insert(clips), insert(clip_words)
_WORDS = (
    select(clip_words.c.clip_id, clip_words.c.word)
    .where(is_one_of(clip_words.c.clip_id, "ids"))
    .order_by(clip_words.c.clip_id, clip_words.c.position)
)


def add_or_get(tx: Tx, new: NewClip) -> AddResult:
    """Adds a clip in the state queued, or returns the existing clip with the same content.

    A failed clip is queued again with the new labels and hints. Any other clip is queued again
    only if `new` has another recording; then it gets the recording and the hints about it.
    """
    # Writers in all processes wait here, so that no two add the same content after the look-up.
    library.lock(tx)
    existing = find_by_content(tx, new.content_key)
    if existing is None:
        return AddResult(_insert(tx, new), AddOutcome.ADDED)
    is_failed = existing.state is ClipState.FAILED
    if is_failed or (new.audio is not None and new.audio.sha256 != existing.audio_sha256):
        again = _requeue_with(tx, existing, new, None if is_failed else ("audio", *AUDIO_HINTS))
        replaced = existing.audio_sha256 if again.audio_sha256 != existing.audio_sha256 else None
        return AddResult(again, AddOutcome.REQUEUED, replaced)
    return AddResult(existing, AddOutcome.EXISTS)


def get(tx: Tx, clip_id: str) -> ClipRecord:
    """The clip; raises ClipNotFound."""
    loaded = _load(tx, [clip_id])
    if not loaded:
        raise _not_found(clip_id)
    return loaded[0]


def get_many(tx: Tx, clip_ids: Collection[str]) -> dict[str, ClipRecord]:
    """The existing clips among `clip_ids`, by id, in the order of `clip_ids`."""
    clip_of = {clip.id: clip for batch in in_batches(clip_ids) for clip in _load(tx, batch)}
    return {clip_id: clip_of[clip_id] for clip_id in clip_ids if clip_id in clip_of}


def searched_version(tx: Tx, clip_id: str) -> int | None:
    """The library version of the last change of a ready clip; None for any other clip."""
    query = visibility.of_visible(_VERSION)
    version: int | None = tx.execute(query, {"the_id": clip_id}).scalar_one_or_none()
    return version


def find_by_content(tx: Tx, content_key: str) -> ClipRecord | None:
    """The clip with this content (`NewClip.content_key`), if there is one."""
    clip_id = tx.execute(_WITH_CONTENT, {"content": content_key}).scalar_one_or_none()
    return None if clip_id is None else get_many(tx, [clip_id]).get(clip_id)


def patch(tx: Tx, clip_id: str, changes: ClipChanges) -> ClipRecord:
    """Changes labels, hints and the recording. Raises ClipNotFound.

    The next search sees the new labels of a ready clip. A new hint or recording has an effect
    only after another analysis: see `requeue`.
    """
    before = get(tx, clip_id)
    values = to_columns(changes)
    if changed_input(before, changes) != before.analysis_input:
        values["is_changed"] = True
    if "words" in changes:
        _set_words(tx, clip_id, changes["words"])
    if _SEARCHED & changes.keys():
        metadata = changed_metadata(before.metadata, changes)
        clip_metadata.put(tx, clip_id, metadata)
        name, path = changes.get("name", before.name), changes.get("path", before.path)
        captions = changes.get("captions", before.captions)
        clip_captions.put(tx, clip_id, captions)
        values["searched"] = searched_text(name, path, metadata, captions)
    if before.state is ClipState.READY and changes.keys() != {"imported"}:  # no search reads it
        values["changed_version"] = library.bump(tx)
    if values:
        tx.execute(update(clips).where(clips.c.id == clip_id).values(values))
    return get(tx, clip_id)


def forget_person(tx: Tx, person: str) -> tuple[str, ...]:
    """Removes the label of a person from all clips; returns the ids of these clips."""
    has_label = clips.c.person == person
    ids = tuple(tx.execute(select(clips.c.id).where(has_label).order_by(clips.c.id)).scalars())
    tx.execute(
        update(clips)
        .where(has_label, clips.c.state == ClipState.READY.value)
        .values(changed_version=library.bump(tx))
    )
    tx.execute(update(clips).where(has_label).values(person=None))
    return ids


def requeue(tx: Tx, clip_id: str) -> ClipRecord:
    """Queue the clip for an analysis.

    A ready clip stays ready with its current analysis until the new one replaces it.
    """
    if _state_of(tx, clip_id) is ClipState.READY:
        _set(tx, clip_id, reanalysis=Reanalysis.QUEUED.value)
    else:
        _enter(tx, clip_id, ClipState.QUEUED, error=None)
    return get(tx, clip_id)


def wait_again(tx: Tx, clip_id: str) -> None:
    """Queue the clip again after its worker died or stopped. A deleted clip is skipped."""
    clip = get_many(tx, [clip_id]).get(clip_id)
    if clip is None:
        return
    if ClipState.PROCESSING is clip.state or Reanalysis.PROCESSING is clip.reanalysis:
        requeue(tx, clip_id)


def set_processing(tx: Tx, clip_id: str) -> None:
    """A worker has begun the analysis of the clip. Raises ClipNotFound."""
    # Most clips are queued: then one statement is enough.
    if tx.execute(_BEGIN, {"the_id": clip_id}).rowcount:
        return
    if _state_of(tx, clip_id) is ClipState.READY:
        _set(tx, clip_id, reanalysis=Reanalysis.PROCESSING.value)
    else:
        _enter(tx, clip_id, ClipState.PROCESSING)


def set_ready(tx: Tx, clip_id: str, facts: ClipFacts) -> None:
    """The clip is analyzed; searches find it after the commit of this transaction."""
    done: dict[str, Any] = {"error": None, "reanalysis": None, "is_changed": False}
    _set(
        tx,
        clip_id,
        state=ClipState.READY.value,
        changed_version=library.bump(tx),
        **done,
        **asdict(facts),
    )


def set_failed(tx: Tx, clip_id: str, problem: dict[str, Any]) -> None:
    """The clip cannot be analyzed; `problem` says why (RFC 9457)."""
    _enter(tx, clip_id, ClipState.FAILED, error=problem, reanalysis=None)


def keep_analysis(tx: Tx, clip_id: str, why: ClipWarning) -> None:
    """Another analysis of a ready clip failed: the clip keeps its analysis and gets a warning."""
    others = [warning for warning in get(tx, clip_id).warnings if warning.code != why.code]
    warnings = [asdict(warning) for warning in (*others, why)]
    _set(tx, clip_id, reanalysis=Reanalysis.FAILED.value, warnings=warnings)


def fail_waiting(tx: Tx, clip_ids: Collection[str], problem: dict[str, Any]) -> None:
    """As `set_failed`, for many clips; clips that do not wait for an analysis do not change."""
    waiting = clips.c.state.in_([ClipState.QUEUED.value, ClipState.PROCESSING.value])
    for batch in in_batches(clip_ids):
        failed = update(clips).where(clips.c.id.in_(batch), waiting)
        tx.execute(failed.values(state=ClipState.FAILED.value, error=problem))


def delete_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """Removes a clip with its words and arrays; returns its last record. Raises ClipNotFound.

    `outcomes.remove_clip` also settles the jobs and imports that wait for the clip.
    """
    deleted = get(tx, clip_id)
    if deleted.changed_version:  # otherwise no search has ever seen it
        library.record_deletion(tx, clip_id)
    tx.execute(delete(clips).where(clips.c.id == clip_id))
    copies = update(clips).where(clips.c.origin_clip_id == clip_id)
    tx.execute(copies.values(origin_deleted=True))
    return deleted


def in_batches(ids: Iterable[str], size: int = IDS_PER_QUERY) -> Iterator[list[str]]:
    """Slices of `ids` that fit into one statement."""
    every = list(ids)
    for start in range(0, len(every), size):
        yield every[start : start + size]


def _insert(tx: Tx, new: NewClip) -> ClipRecord:
    clip_id = new_id("clip")
    values = to_columns(client_fields(new)) | origin_columns(new.origin)
    values |= {
        "id": clip_id,
        "sha256": new.sha256,
        "file_name": new.file_name,
        "file_size": new.file_size,
        "skeleton_sha256": new.skeleton_sha256,
        "content_key": new.content_key,
        "searched": searched_text(
            new.labels.name, new.path, new.labels.metadata, new.labels.captions
        ),
        "state": ClipState.QUEUED.value,
        "changed_version": 0,
        "created_at": utc_now(),
    }
    tx.execute(_ADD, values)
    _add_words(tx, clip_id, new.labels.words)
    clip_metadata.add(tx, clip_id, new.labels.metadata)
    clip_captions.add(tx, clip_id, new.labels.captions)
    return get(tx, clip_id)


def _requeue_with(
    tx: Tx, existing: ClipRecord, new: NewClip, only: Collection[str] | None
) -> ClipRecord:
    """Queue again with the values of `new`; only: names of fields that may change, None for all."""
    changes = {
        name: value
        for name, value in client_fields(new).items()
        if value not in (None, ()) and (only is None or name in only)
    }
    patch(tx, existing.id, changes)
    return requeue(tx, existing.id)


def _set_words(tx: Tx, clip_id: str, words: Sequence[str]) -> None:
    tx.execute(delete(clip_words).where(clip_words.c.clip_id == clip_id))
    _add_words(tx, clip_id, words)


def _add_words(tx: Tx, clip_id: str, words: Sequence[str]) -> None:
    rows = [
        {"clip_id": clip_id, "word": word, "position": position}
        for position, word in enumerate(dict.fromkeys(words))
    ]
    if rows:
        tx.execute(_ADD_WORDS, rows)


def analysis_input(tx: Tx, clip_id: str) -> AnalysisInput:
    """The current `ClipRecord.analysis_input` of a clip. Raises ClipNotFound."""
    row = tx.execute(visibility.of_visible(_INPUT), {"the_id": clip_id}).mappings().one_or_none()
    if row is None:
        raise _not_found(clip_id)
    return input_of(row)


def _enter(tx: Tx, clip_id: str, state: ClipState, **values: Any) -> None:
    before = _state_of(tx, clip_id)
    # Searches see only ready clips, so other changes of the state do not raise the version.
    if ClipState.READY in (before, state):
        values["changed_version"] = library.bump(tx)
    tx.execute(_CHANGE, {"the_id": clip_id, "state": state.value, **values})


def _set(tx: Tx, clip_id: str, **values: Any) -> None:
    """Change columns. Raises ClipNotFound."""
    if not tx.execute(_CHANGE, {"the_id": clip_id, **values}).rowcount:
        raise _not_found(clip_id)


def _state_of(tx: Tx, clip_id: str) -> ClipState:
    """Reads the state only, because every step of an ingest calls it; raises ClipNotFound."""
    state = tx.execute(_STATE, {"the_id": clip_id}).scalar_one_or_none()
    if state is None:
        raise _not_found(clip_id)
    return ClipState(state)


def _not_found(clip_id: str) -> ClipNotFound:
    detail = f"There is no clip with the id {clip_id!r}"
    return ClipNotFound(detail, places=[Place("clip_id", "is the id of no clip")])


def _load(tx: Tx, clip_ids: Collection[str]) -> list[ClipRecord]:
    query = visibility.of_visible(_SOME)
    rows = tx.execute(query, {"ids": as_list(clip_ids)}).mappings().all()
    return to_records(tx, rows)


def to_records(tx: Tx, rows: Sequence[RowMapping]) -> list[ClipRecord]:
    """Rows of `clips` as records, with what other tables hold of them."""
    ids = [row["id"] for row in rows]
    words, metadata = words_of(tx, ids), clip_metadata.get_many(tx, ids)
    captions = clip_captions.get_many(tx, ids)
    return [
        to_record(row, words.get(i, ()), metadata.get(i, {}), captions.get(i, ()))
        for i, row in zip(ids, rows, strict=True)
    ]


def words_of(tx: Tx, clip_ids: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Words by clip id, in the client's order."""
    words_by_id: dict[str, list[str]] = {}
    for clip_id, word in tx.execute(_WORDS, {"ids": as_list(clip_ids)}).all():
        words_by_id.setdefault(clip_id, []).append(word)
    return {clip_id: tuple(words) for clip_id, words in words_by_id.items()}
