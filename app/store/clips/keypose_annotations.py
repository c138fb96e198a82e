"""Keyposes that people annotate: one list of times for each clip, in seconds from its beginning."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from sqlalchemy import delete, insert, select

from app.store.clips import repository as clips
from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.tables import keypose_annotations
from app.store.database.text_list import as_list, is_one_of

# Built once, because every analysis executes it.
_SOME = select(keypose_annotations.c.clip_id, keypose_annotations.c.times).where(
    is_one_of(keypose_annotations.c.clip_id, "ids")
)

Times = tuple[float, ...]
"""Seconds, in rising order."""


def put(tx: Tx, clip_id: str, times: Sequence[float]) -> None:
    """Store the annotation of a clip, which replaces the earlier one; without times, remove it.

    A ready clip counts as changed, so that models are fitted again. Raises ClipNotFound.
    """
    clips.patch(tx, clip_id, {})  # no new values, but it raises the library version
    tx.execute(delete(keypose_annotations).where(keypose_annotations.c.clip_id == clip_id))
    if times:
        row = {"clip_id": clip_id, "times": list(times), "annotated_at": utc_now()}
        tx.execute(insert(keypose_annotations), row)


def get(tx: Tx, clip_id: str) -> Times | None:
    """The annotation of a clip; None if there is none."""
    return get_many(tx, [clip_id]).get(clip_id)


def get_many(tx: Tx, clip_ids: Collection[str]) -> dict[str, Times]:
    """The annotations by clip id, in the order of `clip_ids`; clips without one are left out."""
    times_of: dict[str, Times] = {}
    for batch in clips.in_batches(clip_ids):
        rows = tx.execute(_SOME, {"ids": as_list(batch)})
        times_of |= {clip_id: tuple(times) for clip_id, times in rows}
    return {clip_id: times_of[clip_id] for clip_id in clip_ids if clip_id in times_of}


def annotated(tx: Tx) -> tuple[str, ...]:
    """Ids of the clips that have an annotation, sorted."""
    query = select(keypose_annotations.c.clip_id).order_by(keypose_annotations.c.clip_id)
    return tuple(tx.execute(query).scalars())
