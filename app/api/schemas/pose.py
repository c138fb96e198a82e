"""Searches by pose."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import ConfigDict, Field, Json, WithJsonSchema

from app.api.schemas.base import Cursor, Limit, Outgoing, Seconds
from app.api.schemas.filters import Filter
from app.api.schemas.query_source import ClipId, QueryFields, QueryForm
from app.api.schemas.search import Hit
from app.motion.roles.joint_roles import SUN_ROLES
from app.search.pose.pose_matches import MatchesPerClip
from app.services.find.queries import PoseQuery
from app.services.find.query_source import QuerySource

_POINT = {"type": "array", "items": {"type": "number"}, "minItems": 3, "maxItems": 3}
Positions = Annotated[
    list[Any],
    # The service checks the points, because it can name the joint that is wrong.
    WithJsonSchema(
        {"type": "array", "items": _POINT, "minItems": len(SUN_ROLES), "maxItems": len(SUN_ROLES)}
    ),
]
A_POSE: Any = [
    [0.1, 0.5, 0.0],
    [-0.1, 0.5, 0.0],
    [0.1, 0.1, 0.0],
    [-0.1, 0.1, 0.0],
    [0.0, 0.95, 0.0],
    [0.45, 1.45, 0.0],
    [-0.45, 1.45, 0.0],
    [0.18, 1.45, 0.0],
    [-0.18, 1.45, 0.0],
    [0.0, 1.5, 0.0],
    [0.0, 1.7, 0.0],
    [0.7, 1.45, 0.0],
    [-0.7, 1.45, 0.0],
]
"""Arms stretched out to the sides."""


class _PoseOptions(QueryFields):
    places: MatchesPerClip = Field(
        MatchesPerClip.BEST,
        description="best: one hit for each clip, at its nearest pose; all: one hit for each time "
        "at which a clip takes the pose.",
    )
    limit: Limit = 10
    filter: Filter | None = None
    include_self: bool = Field(
        False,
        description="Whether the query clip may be a hit. A file that is stored already counts as "
        "its clip.",
    )
    cursor: Cursor | None = None

    def query_of(
        self, source: QuerySource | None, time: float | None, positions: list[Any] | None = None
    ) -> PoseQuery:
        """The search for a pose: of `source` at `time`, or of 13 positions."""
        return PoseQuery(
            source=source,
            time=time,
            positions=positions,
            places=self.places,
            limit=self.limit,
            filter=None if self.filter is None else self.filter.given(),
            include_self=self.include_self,
            cursor=self.cursor,
        )


class PoseSearch(_PoseOptions):
    """Find a pose: the pose of a stored clip at a time, or 13 positions."""

    clip_id: ClipId | None = None
    time: Seconds | None = Field(None, description="Seconds from the start of the motion.")
    positions: Positions | None = Field(
        None,
        description=f"x, y (up) and z of {', '.join(SUN_ROLES)}, in this order, in meters. "
        "Position, heading and size do not matter.",
    )

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {"clip_id": "CLIP_ID", "time": 0.5, "limit": 5},
                {"positions": A_POSE, "places": "all"},
            ]
        }
    )

    def query(self) -> PoseQuery:
        """The search for a pose."""
        source = None if self.clip_id is None else self.source()
        return self.query_of(source, self.time, self.positions)


class PoseSearchForm(_PoseOptions, QueryForm):
    """Find the pose of an uploaded motion (never stored), or of a stored clip, at a time."""

    time: Seconds = Field(description="Seconds from the start of the motion.")
    filter: Json[Filter] | None = Field(None, description='JSON, as {"task": ["walk", "run"]}.')


class PoseHit(Hit):
    """A time at which a clip takes a pose; it stays near the pose from start to end."""

    time: float = Field(description="Seconds: when the clip is nearest to the pose.")


class PoseHits(Outgoing):
    """A page of a ranking by pose, the nearest first."""

    method: str
    took_ms: float
    library_version: int
    items: list[PoseHit]
    next: str | None
