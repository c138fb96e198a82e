"""Annotations of clips: spans of time with words, a person and a sentence. One row for each."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum
from typing import Any

from sqlalchemy import RowMapping, bindparam, delete, func, insert, select, update

from app.errors import AnnotationNotFound
from app.kinedex_error import Place
from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.tables import clip_annotations as table


class Origin(StrEnum):
    """Where an annotation comes from."""

    PERSON = "person"
    """A person made it."""
    IMPORT = "import"
    """It came in a file."""
    SUGGESTION = "suggestion"
    """A person accepted what a model suggested."""


@dataclass(frozen=True, slots=True)
class NewAnnotation:
    """What is said about a part of a clip.

    start, end: seconds from the clip's start; by: who said it; probability: of an accepted
    suggestion, what the model said, 0..1.
    """

    start: float
    end: float
    words: tuple[str, ...] = ()
    person: str | None = None
    text: str | None = None
    by: str | None = None
    origin: Origin = Origin.PERSON
    probability: float | None = None


@dataclass(frozen=True, slots=True)
class Annotation(NewAnnotation):
    """A stored annotation."""

    id: str = ""
    clip_id: str = ""


_OF_CLIPS = (
    select(table)
    .where(table.c.clip_id.in_(bindparam("ids", expanding=True)))
    .order_by(table.c.clip_id, table.c.start_s, table.c.end_s, table.c.id)
)
_ADD = insert(table)


def put(tx: Tx, clip_id: str, new: Sequence[NewAnnotation]) -> None:
    """Replace all annotations of a clip.

    A ready clip counts as changed, so that models are fitted again. Raises ClipNotFound.
    """
    clips.patch(tx, clip_id, {})  # no new values, but it raises the library version
    tx.execute(delete(table).where(table.c.clip_id == clip_id))
    if new:
        tx.execute(_ADD, [_row(clip_id, one) for one in new])


def add(tx: Tx, clip_id: str, new: NewAnnotation) -> Annotation:
    """Add an annotation to a clip. Raises ClipNotFound."""
    clips.patch(tx, clip_id, {})
    row = _row(clip_id, new)
    tx.execute(_ADD, [row])
    return get(tx, clip_id, row["id"])


def change(tx: Tx, clip_id: str, annotation_id: str, new: NewAnnotation) -> Annotation:
    """Replace what an annotation says. Raises ClipNotFound, AnnotationNotFound."""
    get(tx, clip_id, annotation_id)
    clips.patch(tx, clip_id, {})
    tx.execute(update(table).where(table.c.id == annotation_id).values(_values(new)))
    return get(tx, clip_id, annotation_id)


def remove(tx: Tx, clip_id: str, annotation_id: str) -> None:
    """Remove an annotation. Raises ClipNotFound, AnnotationNotFound."""
    get(tx, clip_id, annotation_id)
    clips.patch(tx, clip_id, {})
    tx.execute(delete(table).where(table.c.id == annotation_id))


def get(tx: Tx, clip_id: str, annotation_id: str) -> Annotation:
    """An annotation of a clip. Raises ClipNotFound, AnnotationNotFound."""
    clips.get(tx, clip_id)
    query = select(table).where(table.c.id == annotation_id, table.c.clip_id == clip_id)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        raise AnnotationNotFound(
            f"The clip {clip_id} has no annotation {annotation_id!r:.120}.",
            places=[Place("annotation_id", "is no annotation's id")],
        )
    return _annotation(row)


def of_clip(tx: Tx, clip_id: str) -> tuple[Annotation, ...]:
    """The annotations of a clip, by start. Raises ClipNotFound."""
    clips.get(tx, clip_id)
    return get_many(tx, [clip_id]).get(clip_id, ())


def get_many(tx: Tx, clip_ids: Collection[str]) -> dict[str, tuple[Annotation, ...]]:
    """Annotations by clip id, by start; clips without one are left out."""
    found: dict[str, list[Annotation]] = {}
    for batch in clips.in_batches(clip_ids):
        for row in tx.execute(_OF_CLIPS, {"ids": batch}).mappings():
            found.setdefault(row["clip_id"], []).append(_annotation(row))
    return {clip_id: tuple(some) for clip_id, some in found.items()}


def count(tx: Tx, clip_id: str) -> int:
    """The number of annotations of a clip."""
    query = select(func.count()).select_from(table).where(table.c.clip_id == clip_id)
    return int(tx.execute(query).scalar_one())


def annotated(tx: Tx) -> tuple[str, ...]:
    """Ids of the clips that have an annotation, sorted."""
    query = select(table.c.clip_id).distinct().order_by(table.c.clip_id)
    return tuple(tx.execute(query).scalars())


def person_names(tx: Tx) -> frozenset[str]:
    """All persons that annotations name."""
    query = select(table.c.person).where(table.c.person.is_not(None)).distinct()
    return frozenset(tx.execute(query).scalars())


def clips_of_person(tx: Tx, person: str) -> tuple[str, ...]:
    """Ids of the clips with an annotation of this person, sorted."""
    query = select(table.c.clip_id).where(table.c.person == person).distinct()
    return tuple(sorted(tx.execute(query).scalars()))


def every(tx: Tx) -> Iterable[Annotation]:
    """All annotations of the library, in batches of clips."""
    for batch in clips.in_batches(annotated(tx)):
        for some in get_many(tx, batch).values():
            yield from some


def rewrite(tx: Tx, changed: Sequence[Annotation]) -> None:
    """Store other words, persons and texts of annotations, and count their clips as changed."""
    for clip_id in sorted({one.clip_id for one in changed}):
        clips.patch(tx, clip_id, {})
    for one in changed:
        tx.execute(update(table).where(table.c.id == one.id).values(_values(one)))


def _row(clip_id: str, new: NewAnnotation) -> dict[str, Any]:
    return {"id": new_id("annotation"), "clip_id": clip_id, **_values(new)}


def _values(new: NewAnnotation) -> dict[str, Any]:
    return {
        "start_s": new.start,
        "end_s": new.end,
        "words": list(new.words),
        "person": new.person,
        "text": new.text,
        "said_by": new.by,
        "origin": new.origin.value,
        "probability": new.probability,
        "changed_at": utc_now(),
    }


def _annotation(row: RowMapping) -> Annotation:
    return Annotation(
        start=row["start_s"],
        end=row["end_s"],
        words=tuple(row["words"]),
        person=row["person"],
        text=row["text"],
        by=row["said_by"],
        origin=Origin(row["origin"]),
        probability=row["probability"],
        id=row["id"],
        clip_id=row["clip_id"],
    )


def within(found: Iterable[Annotation], seconds: float) -> tuple[Annotation, ...]:
    """The annotations inside of a clip that is `seconds` long; those that reach out are cut.

    Annotations of an import are stored before the length of the clip is known.
    """
    return tuple(replace(one, end=min(one.end, seconds)) for one in found if one.start < seconds)
