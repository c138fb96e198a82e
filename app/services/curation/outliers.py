"""Outliers within a task: to look at, to accept (the label changes), or to dismiss."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from app.errors import Conflict, NotFound
from app.kinedex_error import Place
from app.search.outliers.outliers import Outlier, OutlierReason, far_ones, swapped_ones
from app.services.clips.catalogue import get_clip, update_clip
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord
from app.store.curation import dismissed_outliers

_SIDE = re.compile(r"left|right", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class LabelOutlier:
    """A clip that differs from the others with its task; see `Outlier`."""

    clip: ClipRecord
    task: str
    reason: OutlierReason
    score: float
    value: float
    usual: float
    suggested: str | None


def list_outliers(lib: Library, filter: ClipFilter, limit: int = 10) -> list[LabelOutlier]:
    """The outliers among the clips that pass a filter, the most unusual first.

    Clips are compared with all clips of their task, also with those that do not pass.
    """
    lib.index.catch_up(lib.store)
    view = lib.index.state[1]
    numbers = np.flatnonzero(view.labels.mask(ClipFilter()))
    coded = view.labels.labels.named["task"]
    names = coded.labels
    no_task = names.index(None) if None in names else -1
    codes = view.labels.coded["task"][numbers].astype(np.int64)
    codes = np.where(codes == no_task, -1, codes)
    found: list[Outlier] = [
        *far_ones(view.vectors(numbers), codes),
        *swapped_ones(view.labels.measured("dominance")[numbers], codes),
    ]
    passes = view.labels.mask(resolved_filter(lib, filter))
    ids = view.labels.ids[numbers]
    with lib.store.read() as tx:
        dismissed = dismissed_outliers.every(tx)
        chosen = [
            (one, str(names[codes[one.number]]))
            for one in sorted(found, key=lambda one: -one.score)
            if passes[numbers[one.number]]
        ]
        shown = [
            (one, task)
            for one, task in chosen
            if (ids[one.number], one.reason.value, task) not in dismissed
        ][:limit]
        records = clips.get_many(tx, [ids[one.number] for one, _ in shown])
    return [
        LabelOutlier(
            clip=records[ids[one.number]],
            task=task,
            reason=one.reason,
            score=one.score,
            value=one.value,
            usual=one.usual,
            suggested=_suggested(one, task, names),
        )
        for one, task in shown
        if ids[one.number] in records
    ]


def accept(lib: Library, clip_id: str, reason: OutlierReason, task: str | None) -> ClipRecord:
    """The label is wrong: change the task of the clip, and the sides in its words.

    task: the right one; by default the suggested one. Raises ClipNotFound, BadField, NotFound if
    the clip is no outlier, Conflict if nothing is suggested.
    """
    clip = get_clip(lib, clip_id)
    if task is None:
        task = _outlier(lib, clip, reason).suggested
    if task is None:
        raise Conflict(f"No task is suggested for the clip {clip_id}: send `task`.")
    changes: dict[str, object] = {"task": task}
    if reason is OutlierReason.SWAPPED:
        changes["words"] = tuple(map(other_side, clip.words))
    return update_clip(lib, clip_id, changes)


def dismiss(lib: Library, clip_id: str, reason: OutlierReason) -> None:
    """The label is right: no list shows the clip for this reason while it has this task.

    Raises ClipNotFound, and NotFound for a clip without a task.
    """
    clip = get_clip(lib, clip_id)
    if clip.task is None:
        raise _no_outlier(clip_id)
    with lib.store.write() as tx:
        dismissed_outliers.add(tx, clip_id, reason.value, clip.task)


def other_side(text: str) -> str:
    """A label with left and right exchanged."""
    return _SIDE.sub(lambda found: "right" if found[0].casefold() == "left" else "left", text)


def _outlier(lib: Library, clip: ClipRecord, reason: OutlierReason) -> LabelOutlier:
    some = ClipFilter(task=(clip.task,)) if clip.task is not None else ClipFilter()
    for one in list_outliers(lib, some, limit=len(lib.index)):
        if (one.clip.id, one.reason) == (clip.id, reason):
            return one
    raise _no_outlier(clip.id)


def _no_outlier(clip_id: str) -> NotFound:
    places = [Place("clip_id", "is the id of no outlier")]
    return NotFound(f"The clip {clip_id} is no outlier within its task", places=places)


def _suggested(one: Outlier, task: str, names: tuple[str | None, ...]) -> str | None:
    if one.reason is OutlierReason.SWAPPED:
        exchanged = other_side(task)
        return None if exchanged == task else exchanged
    return None if one.suggested is None else names[one.suggested]
