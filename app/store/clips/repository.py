"""Clips: adding, reading, changing, removing. `listing` lists them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import asdict
from typing import Any

from sqlalchemy import bindparam, delete, insert, select, update

from app.errors import ClipNotFound, Place
from app.store.clips import versions as library
from app.store.clips.record import (
    AUDIO_HINTS,
    Added,
    AddOutcome,
    AnalysisInput,
    ClipChanges,
    ClipFacts,
    ClipRecord,
    ClipState,
    ClipWarning,
    NewClip,
    Reanalysis,
)
from app.store.clips.rows import changed_input, said_by_client, to_columns, to_record
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.tables import clip_words, clips

IDS_PER_QUERY = 500
"""Databases limit the parameters of one statement."""

# Made once: making a statement costs more than running it.
_SOME = select(clips).where(clips.c.id.in_(bindparam("ids", expanding=True)))
_STATE = select(clips.c.state).where(clips.c.id == bindparam("the_id"))
_VERSION = select(clips.c.changed_version).where(
    clips.c.id == bindparam("the_id"), clips.c.state == ClipState.READY.value
)
_WITH_CONTENT = select(clips.c.id).where(clips.c.content_key == bindparam("content"))
_CHANGE = update(clips).where(clips.c.id == bindparam("the_id"))
_ADD, _ADD_WORDS = insert(clips), insert(clip_words)
_WORDS = (
    select(clip_words.c.clip_id, clip_words.c.word)
    .where(clip_words.c.clip_id.in_(bindparam("ids", expanding=True)))
    .order_by(clip_words.c.clip_id, clip_words.c.position)
)


def add_or_get(tx: Tx, new: NewClip) -> Added:
    """Adds a clip in the state queued, or finds the clip with the same content.

    A failed one is queued again, with the labels and hints that are given now; any other is queued
    again only if it comes with another recording, with that and the hints about it. Safe between
    processes: writers take turns, so that no other can add the same content after the look-up.
    """
    library.lock(tx)
    found = find_by_content(tx, new.content_key)
    if found is None:
        return Added(_insert(tx, new), AddOutcome.ADDED)
    is_failed = found.state is ClipState.FAILED
    if is_failed or (new.audio is not None and new.audio.sha256 != found.audio_sha256):
        again = _requeue_with(tx, found, new, None if is_failed else ("audio", *AUDIO_HINTS))
        replaced = found.audio_sha256 if again.audio_sha256 != found.audio_sha256 else None
        return Added(again, AddOutcome.REQUEUED, replaced)
    return Added(found, AddOutcome.EXISTS)


def get(tx: Tx, clip_id: str) -> ClipRecord:
    """The clip; raises ClipNotFound."""
    found = _load(tx, [clip_id])
    if not found:
        raise _not_found(clip_id)
    return found[0]


def get_many(tx: Tx, clip_ids: Collection[str]) -> dict[str, ClipRecord]:
    """The clips that exist among `clip_ids`, by id, in the order asked for."""
    found = {clip.id: clip for batch in in_batches(clip_ids) for clip in _load(tx, batch)}
    return {clip_id: found[clip_id] for clip_id in clip_ids if clip_id in found}


def searched_version(tx: Tx, clip_id: str) -> int | None:
    """The library version of the last change of a ready clip; None for any other clip."""
    version: int | None = tx.execute(_VERSION, {"the_id": clip_id}).scalar_one_or_none()
    return version


def find_by_content(tx: Tx, content_key: str) -> ClipRecord | None:
    """The clip with this content (`NewClip.content_key`), if there is one."""
    clip_id = tx.execute(_WITH_CONTENT, {"content": content_key}).scalar_one_or_none()
    return None if clip_id is None else get(tx, clip_id)


def patch(tx: Tx, clip_id: str, changes: ClipChanges) -> ClipRecord:
    """Changes labels, hints and the recording; the next search sees a ready clip's change.

    A changed hint or recording takes effect with the next analysis: see `requeue`.
    """
    before = get(tx, clip_id)
    values = to_columns(changes)
    if changed_input(before, changes) != before.analysis_input:
        values["is_changed"] = True
    if "words" in changes:
        _set_words(tx, clip_id, changes["words"])
    if before.state is ClipState.READY:
        values["changed_version"] = library.bump(tx)
    if values:
        tx.execute(update(clips).where(clips.c.id == clip_id).values(values))
    return get(tx, clip_id)


def forget_person(tx: Tx, person: str) -> tuple[str, ...]:
    """Removes a person's label from all their clips; returns the ids of these."""
    theirs = clips.c.person == person
    ids = tuple(tx.execute(select(clips.c.id).where(theirs).order_by(clips.c.id)).scalars())
    tx.execute(
        update(clips)
        .where(theirs, clips.c.state == ClipState.READY.value)
        .values(changed_version=library.bump(tx))
    )
    tx.execute(update(clips).where(theirs).values(person=None))
    return ids


def requeue(tx: Tx, clip_id: str) -> ClipRecord:
    """Let the clip wait for an analysis. A ready clip stays ready with the analysis that it has,
    until the new one replaces it."""
    if _state_of(tx, clip_id) is ClipState.READY:
        _set(tx, clip_id, reanalysis=Reanalysis.QUEUED.value)
    else:
        _enter(tx, clip_id, ClipState.QUEUED, error=None)
    return get(tx, clip_id)


def wait_again(tx: Tx, clip_id: str) -> None:
    """The clip's worker is gone and its job waits again. A clip that was deleted needs nothing."""
    clip = get_many(tx, [clip_id]).get(clip_id)
    if clip is None:
        return
    if ClipState.PROCESSING is clip.state or Reanalysis.PROCESSING is clip.reanalysis:
        requeue(tx, clip_id)


def set_processing(tx: Tx, clip_id: str) -> None:
    """A worker has begun its analysis."""
    begun = update(clips).where(clips.c.id == clip_id, clips.c.state == ClipState.QUEUED.value)
    if tx.execute(begun.values(state=ClipState.PROCESSING.value)).rowcount:
        return
    if _state_of(tx, clip_id) is ClipState.READY:
        _set(tx, clip_id, reanalysis=Reanalysis.PROCESSING.value)
    else:
        _enter(tx, clip_id, ClipState.PROCESSING)


def set_ready(tx: Tx, clip_id: str, facts: ClipFacts) -> None:
    """The clip is analyzed: searches find it as soon as this transaction is committed."""
    done: dict[str, Any] = {"error": None, "reanalysis": None, "is_changed": False}
    _enter(tx, clip_id, ClipState.READY, **done, **asdict(facts))


def set_failed(tx: Tx, clip_id: str, problem: dict[str, Any]) -> None:
    """The clip cannot be analyzed; problem: why (RFC 9457)."""
    _enter(tx, clip_id, ClipState.FAILED, error=problem, reanalysis=None)


def keep_analysis(tx: Tx, clip_id: str, why: ClipWarning) -> None:
    """Another analysis of a ready clip failed: the clip keeps the one it has, and says why."""
    others = [warning for warning in get(tx, clip_id).warnings if warning.code != why.code]
    warnings = [asdict(warning) for warning in (*others, why)]
    _set(tx, clip_id, reanalysis=Reanalysis.FAILED.value, warnings=warnings)


def fail_waiting(tx: Tx, clip_ids: Collection[str], problem: dict[str, Any]) -> None:
    """As `set_failed`, of many clips; those that do not wait for an analysis stay as they are."""
    waiting = clips.c.state.in_([ClipState.QUEUED.value, ClipState.PROCESSING.value])
    for batch in in_batches(clip_ids):
        failed = update(clips).where(clips.c.id.in_(batch), waiting)
        tx.execute(failed.values(state=ClipState.FAILED.value, error=problem))


def delete_clip(tx: Tx, clip_id: str) -> ClipRecord:
    """Removes the row with its words and arrays; returns what it was. Raises ClipNotFound.

    Jobs and imports that wait for it: use `outcomes.remove_clip`.
    """
    gone = get(tx, clip_id)
    if gone.changed_version:
        library.bury(tx, clip_id)
    tx.execute(delete(clips).where(clips.c.id == clip_id))
    return gone


def in_batches(ids: Iterable[str], size: int = IDS_PER_QUERY) -> Iterator[list[str]]:
    """Slices of `ids` that fit into one statement."""
    every = list(ids)
    for start in range(0, len(every), size):
        yield every[start : start + size]


def _insert(tx: Tx, new: NewClip) -> ClipRecord:
    clip_id = new_id("clip")
    values = to_columns(said_by_client(new)) | {
        "id": clip_id,
        "sha256": new.sha256,
        "file_name": new.file_name,
        "file_size": new.file_size,
        "skeleton_sha256": new.skeleton_sha256,
        "content_key": new.content_key,
        "state": ClipState.QUEUED.value,
        "changed_version": 0,
        "created_at": utc_now(),
    }
    tx.execute(_ADD, values)
    _add_words(tx, clip_id, new.labels.words)
    return get(tx, clip_id)


def _requeue_with(
    tx: Tx, found: ClipRecord, new: NewClip, only: Collection[str] | None
) -> ClipRecord:
    """Queue again with what is given now; `only`: names of the fields that may change."""
    given = {
        name: value
        for name, value in said_by_client(new).items()
        if value not in (None, ()) and (only is None or name in only)
    }
    patch(tx, found.id, given)
    return requeue(tx, found.id)


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
    """As `ClipRecord.analysis_input`, of a clip as it is now. Raises ClipNotFound."""
    return get(tx, clip_id).analysis_input


def _enter(tx: Tx, clip_id: str, state: ClipState, **values: Any) -> None:
    before = _state_of(tx, clip_id)
    if ClipState.READY in (before, state):
        values["changed_version"] = library.bump(tx)
    tx.execute(_CHANGE, {"the_id": clip_id, "state": state.value, **values})


def _set(tx: Tx, clip_id: str, **values: Any) -> None:
    """Change columns that no search reads."""
    tx.execute(_CHANGE, {"the_id": clip_id, **values})


def _state_of(tx: Tx, clip_id: str) -> ClipState:
    """The state alone, for every step of every ingest; raises ClipNotFound."""
    state = tx.execute(_STATE, {"the_id": clip_id}).scalar_one_or_none()
    if state is None:
        raise _not_found(clip_id)
    return ClipState(state)


def _not_found(clip_id: str) -> ClipNotFound:
    detail = f"There is no clip with the id {clip_id!r}"
    return ClipNotFound(detail, places=[Place("clip_id", "is the id of no clip")])


def _load(tx: Tx, clip_ids: Collection[str]) -> list[ClipRecord]:
    rows = tx.execute(_SOME, {"ids": list(clip_ids)}).mappings().all()
    words = words_of(tx, clip_ids)
    return [to_record(row, words.get(row["id"], ())) for row in rows]


def words_of(tx: Tx, clip_ids: Collection[str]) -> dict[str, tuple[str, ...]]:
    """Words by clip id, in the order in which they were given."""
    found: dict[str, list[str]] = {}
    for batch in in_batches(clip_ids):
        for clip_id, word in tx.execute(_WORDS, {"ids": batch}):
            found.setdefault(clip_id, []).append(word)
    return {clip_id: tuple(words) for clip_id, words in found.items()}
