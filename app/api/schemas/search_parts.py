"""The parts of a search by several parts: examples, poses in order, and a rhythm."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from app.api.schemas.base import Incoming, Seconds
from app.api.schemas.pose import Positions
from app.api.schemas.query_source import ClipId
from app.search.composed.body_parts import BodyPart
from app.services.find.criteria import MAX_POSES, MAX_RATE, MAX_TOLERANCE, MAX_WEIGHT
from app.services.find.queries import Example, PoseQuery, PoseSequence, Rhythm
from app.services.find.query_source import QuerySource

Weight = Annotated[
    float, Field(gt=0, le=MAX_WEIGHT, description="How much it counts, relative to the others.")
]


class SearchExample(Incoming):
    """A stored clip, or a part of it, that hits must be like, or must not be like."""

    clip_id: ClipId
    start: Seconds | None = Field(None, description="Start of the part, seconds.")
    end: Seconds | None = Field(None, description="End of the part, seconds.")
    weight: Weight = 1.0
    against: bool = Field(False, description="Whether hits must not be like it.")
    body_part: BodyPart | None = Field(
        None,
        description="The part of the body that counts; by default all of it. Arms: elbows and "
        "hands; legs: knees and feet; upper_body: all above the hips. It is compared by warping.",
    )

    def part(self, index: int) -> Example:
        """The example at this index of a query."""
        source = QuerySource(clip_id=self.clip_id, start=self.start, end=self.end)
        return Example(f"examples.{index}", source, self.weight, self.against, self.body_part)


class SearchPose(Incoming):
    """A pose: of a stored clip at a time, or 13 positions, as in a search by pose."""

    clip_id: ClipId | None = None
    time: Seconds | None = Field(None, description="Seconds from the start of the clip.")
    positions: Positions | None = Field(None, description="As in `POST /v1/search/pose`.")

    def pose(self) -> PoseQuery:
        """The pose for the service."""
        source = None if self.clip_id is None else QuerySource(clip_id=self.clip_id)
        return PoseQuery(source=source, time=self.time, positions=self.positions)


class SearchPoses(Incoming):
    """Poses that hits take one after the other: "from this to that"."""

    sequence: list[SearchPose] = Field(min_length=1, max_length=MAX_POSES)
    weight: Weight = 1.0
    against: bool = Field(False, description="Whether hits must not take them.")

    def part(self) -> PoseSequence:
        """The poses for the service."""
        return PoseSequence([one.pose() for one in self.sequence], self.weight, self.against)


class SearchRhythm(Incoming):
    """A rhythm in which hits move: a walk has about 55 cycles, or 110 steps, a minute."""

    cycles_per_minute: float = Field(
        gt=0,
        le=MAX_RATE,
        description="Of the poses; half of it fits too, since a measured cycle may be two.",
    )
    tolerance: float = Field(
        0.1, gt=0, le=MAX_TOLERANCE, description="A share of it at which the score is halved."
    )
    weight: Weight = 1.0
    against: bool = Field(False, description="Whether hits must not move in it.")

    def part(self) -> Rhythm:
        """The rhythm for the service."""
        return Rhythm(self.cycles_per_minute, self.tolerance, self.weight, self.against)
