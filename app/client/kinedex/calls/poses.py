"""Calls: poses. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from kinedex.call import Call, record
from kinedex.sent import given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.choices import MatchesPerClip
    from kinedex.types.pose import PoseHits


def search_pose(
    clip_id: str | None = None,
    *,
    fields: Sequence[str] | None = None,
    time: float | None = None,
    positions: Sequence[Sequence[float]] | None = None,
    places: MatchesPerClip | None = None,
    limit: int | None = None,
    filter: Filter | None = None,
    include_self: bool | None = None,
    cursor: str | None = None,
) -> Call[PoseHits]:
    """Find the clips that take a pose, and the times at which they do.

    time: Seconds from the start of the clip.
    positions: x, y (up) and z of left_knee, right_knee, left_foot, right_foot, hips, left_elbow,
        right_elbow, left_shoulder, right_shoulder, neck, head, left_hand, right_hand, in this
        order, in meters. Position, heading and size do not matter.
    places: best: one hit for each clip, at its nearest pose; all: one hit for each time at which
        a clip takes the pose. Default: best.
    limit: Maximum number of items in one answer. Default: 10.
    include_self: Whether the query clip may be a hit. Default: False.
    """
    from kinedex.types.pose import PoseHits

    return Call(
        "search_pose",
        "POST",
        "/v1/search/pose",
        record(PoseHits),
        query=given(fields=fields),
        json=given(
            clip_id=clip_id,
            time=time,
            positions=positions,
            places=places,
            limit=limit,
            filter=filter,
            include_self=include_self,
            cursor=cursor,
        ),
    )
