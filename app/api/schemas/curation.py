"""Near-duplicates and outliers: what people look at to keep a library clean."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.schemas.base import Cursor, Incoming, Label, Limit, Outgoing, Paged
from app.api.schemas.clips import Clip
from app.api.schemas.filters import Filter
from app.search.duplicates.kinds import MAX_SIMILAR, PairKind
from app.search.outliers.outliers import OutlierReason

Threshold = Annotated[
    float,
    Field(
        ge=0,
        le=MAX_SIMILAR,
        description="Largest distance of two takes that count as almost the same. 0: only copies of"
        " one take. 0.1: takes that hardly anybody can tell apart.",
    ),
]


class DuplicateThreshold(Incoming):
    """The threshold of a list of groups."""

    threshold: Threshold = 0.0


class DuplicateQuery(DuplicateThreshold):
    """A page of groups."""

    kind: PairKind | None = Field(None, description="Only pairs of this kind.")
    limit: Limit = 10
    cursor: Cursor | None = None


class DuplicatePair(Outgoing):
    """Two clips that are alike, and the evidence."""

    clip_id: str
    other_id: str
    kind: PairKind
    distance: float = Field(
        ge=0, description="What differs in the movement: 0 is the same, about 1 is unrelated."
    )
    offset: float = Field(ge=0, description="Between the mean poses, body lengths.")
    shift: float = Field(description="Seconds of the first clip at which the other one begins.")
    seconds: float = Field(ge=0, description="Length of the overlap.")
    is_mirrored: bool = Field(description="Whether left and right are exchanged.")


class DuplicateGroup(Outgoing):
    """Clips that are connected by pairs."""

    id: str
    keeper: str = Field(
        description="The clip to keep: the longest, then that with most joints, the highest frame "
        "rate, most labels, and the oldest."
    )
    clips: list[Clip] = Field(description="The keeper first.")
    pairs: list[DuplicatePair]


class DuplicateGroups(Paged):
    """A page of groups, the largest first."""

    items: list[DuplicateGroup]
    pending: int = Field(
        ge=0, description="Clips that a worker has not compared with the others yet."
    )


class OutlierQuery(Filter):
    """Which outliers to list."""

    limit: Limit = 10


class LabelOutlier(Outgoing):
    """A clip that differs from the others with its task."""

    clip: Clip
    task: str
    reason: OutlierReason
    score: float = Field(description="How unusual it is; more is worse.")
    value: float = Field(
        description="`far`: mean distance to the nearest clips of the task. `swapped`: dominance of"
        " the left side, -1..1."
    )
    usual: float = Field(description="The median of the task's clips.")
    suggested: str | None = Field(description="The task that the clip may show instead.")


class OutlierList(Outgoing):
    """Outliers, the most unusual first; `next` is always null."""

    items: list[LabelOutlier]
    next: str | None = None


class DismissedOutlier(Incoming):
    """The reason that is none."""

    reason: OutlierReason


class AcceptedOutlier(DismissedOutlier):
    """The reason that is right, and the right task."""

    task: Label | None = Field(None, description="Default: the suggested task.")
