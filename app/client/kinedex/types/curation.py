"""Answers: curation. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record
from kinedex.types.choices import OutlierReason, PairKind
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class DuplicatePair(Record):
    """Two clips that are alike, and the evidence.

    distance: What differs in the movement: 0 is the same, about 1 is unrelated.
    offset: Between the mean poses, body lengths.
    shift: Seconds of the first clip at which the other one begins.
    seconds: Length of the overlap.
    is_mirrored: Whether left and right are exchanged.
    """

    clip_id: str
    other_id: str
    kind: PairKind
    distance: float
    offset: float
    shift: float
    seconds: float
    is_mirrored: bool


@dataclass(frozen=True, slots=True)
class DuplicateGroup(Record):
    """Clips that are connected by pairs.

    keeper: The clip to keep: the longest, then that with most joints, the highest frame rate,
    most labels, and the oldest.
    clips: The keeper first.
    """

    id: str
    keeper: str
    clips: list[Clip]
    pairs: list[DuplicatePair]


@dataclass(frozen=True, slots=True)
class DuplicateGroups(Page[DuplicateGroup]):
    """A page of groups, the largest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    pending: Clips that a worker has not compared with the others yet.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[DuplicateGroup]
    pending: int


@dataclass(frozen=True, slots=True)
class LabelOutlier(Record):
    """A clip that differs from the others with its task.

    score: How unusual it is; more is worse.
    value: `far`: mean distance to the nearest clips of the task. `swapped`: dominance of the
    left side, -1..1.
    usual: The median of the task's clips.
    suggested: The task that the clip may show instead.
    """

    clip: Clip
    task: str
    reason: OutlierReason
    score: float
    value: float
    usual: float
    suggested: str | None


@dataclass(frozen=True, slots=True)
class OutlierList(Page[LabelOutlier]):
    """Outliers, the most unusual first; `next` is always null."""

    items: list[LabelOutlier]
    next: str | None
