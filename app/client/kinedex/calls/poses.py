"""Calls: poses. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal

from kinedex.call import Call, record
from kinedex.sent import FileInput, Progress, given

if TYPE_CHECKING:
    from kinedex.types.bodies import Filter
    from kinedex.types.choices import MatchesPerClip
    from kinedex.types.pose import PoseHits


def search_pose(
    clip_id: str | None = None,
    *,
    fields: Sequence[str] | None = None,
    file: FileInput | None = None,
    skeleton: FileInput | None = None,
    unit: str | None = None,
    frame_rate: float | None = None,
    up_axis: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None,
    roles: str | Mapping[str, Any] | None = None,
    stack: str | None = None,
    places: MatchesPerClip | None = None,
    limit: int | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    include_self: bool | None = None,
    cursor: str | None = None,
    time: float | None = None,
    positions: Sequence[Sequence[float]] | None = None,
    progress: Progress | None = None,
) -> Call[PoseHits]:
    """Find the clips that take a pose, and the times at which they do.

    The pose is that of a stored clip or of an uploaded file at a time, or 13 positions.

    fields: Members of each item, with commas between them, as in `id,name`; of the clip of a hit
        as in `score,clip.id`. Default: all. Other members are then left out, even if the schema
        of the answer requires them.
    file: The query motion, in any format that an upload may have. It is never stored.
    skeleton: The ASF file that an AMC file needs.
    unit: m, dm, cm, mm, in, ft, cmu (unit of the CMU files), or meters per unit.
    frame_rate: It replaces the frame rate that the file declares.
    up_axis: The axis of the file that points up. Without it, the axis that the file says is
        used, else the one along which the body stands: then the clip has the warning
        `up_axis_guessed`.
    roles: JSON: joint name by role, as in {"hips": "Pelvis"}; a list of two names is for their
        middle, as in {"hips": ["LHip", "RHip"]}. A body that seems to be an animal is refused as
        `skeleton_not_human`, with the reasons, unless roles are sent.
    stack: The name of the animation stack to read, if an FBX file has several; default: the
        longest. The clip's warning `stack_chosen` lists them.
    places: best: one hit for each clip, at its nearest pose; all: one hit for each time at which
        a clip takes the pose. Default: best.
    limit: Maximum number of items in one answer. Default: 10.
    include_self: Whether the query clip may be a hit. A file that is stored already counts as
        its clip. Default: False.
    time: Seconds from the start of the motion.
    positions: x, y (up) and z of left_knee, right_knee, left_foot, right_foot, hips, left_elbow,
        right_elbow, left_shoulder, right_shoulder, neck, head, left_hand, right_hand, in this
        order, in meters. Position, heading and size do not matter.
    progress: Called with the bytes that were sent and the bytes in total.
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
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            places=places,
            limit=limit,
            filter=filter,
            include_self=include_self,
            cursor=cursor,
            time=time,
            positions=positions,
        ),
        fields=given(
            clip_id=clip_id,
            unit=unit,
            frame_rate=frame_rate,
            up_axis=up_axis,
            roles=roles,
            stack=stack,
            places=places,
            limit=limit,
            filter=filter,
            include_self=include_self,
            cursor=cursor,
            time=time,
            positions=positions,
        ),
        files=given(file=file, skeleton=skeleton),
        progress=progress,
    )
