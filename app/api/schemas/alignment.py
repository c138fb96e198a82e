"""Two clips along the path that warps one onto the other."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import Field

from app.api.schemas.base import Id, Incoming, Outgoing, Seconds
from app.api.schemas.views import plain
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.services.comparison.alignment import AlignedClips, Part

_TIME_DIGITS, _LENGTH_DIGITS = 6, 4
"""Decimals of seconds and of meters: a tenth of a millimeter is less than any recording knows."""

Pair = Annotated[list[float], Field(min_length=2, max_length=2)]
"""A number of the first and of the second clip."""


class AlignmentQuery(Incoming):
    """The clip to align with, and the parts of both clips."""

    other: Id = Field(
        description="Id of the second clip. It may be the same clip, with another part.",
        json_schema_extra={"examples": ["CLIP_ID"]},
    )
    start: Seconds | None = Field(None, description="Start of the part of the first clip, seconds.")
    end: Seconds | None = Field(None, description="End of the part of the first clip, seconds.")
    other_start: Seconds | None = Field(None, description="The same for the second clip.")
    other_end: Seconds | None = Field(None, description="The same for the second clip.")

    def parts(self, clip_id: str) -> tuple[Part, Part]:
        """Return the parts of both clips for the service."""
        other = Part(self.other, self.other_start, self.other_end)
        return Part(clip_id, self.start, self.end), other


class Peak(Outgoing):
    """A moment at which the two motions differ much."""

    times: Pair = Field(description="Seconds from the start of the first and the second clip.")
    difference: float = Field(description="Mean over the joints, meters.")
    joint: JointRole = Field(description="The joint that differs most.")
    joint_difference: float = Field(description="Meters.")


class Alignment(Outgoing):
    """Two clips along their warping path: steps, joints, and how far the joints are apart."""

    distance: float = Field(
        description="Mean cost of a step. A search with `method=dtw` has the same distance."
    )
    body_lengths: Pair = Field(
        description="Meters: torso, neck to head, and shin. Both bodies are scaled to the mean of "
        "these two lengths before their joints are compared."
    )
    path: list[Pair] = Field(
        description="(steps, 2): seconds from the start of the first and of the second clip. "
        "Neither ever falls."
    )
    joints: list[JointRole] = Field(description="The 13 joints of figure 2 in Sun 2011.")
    differences: list[list[float]] = Field(
        description="(steps, joints), meters: distance of the joint of one body from the same "
        "joint of the other, with the hips of both at one place and both turned the same way."
    )
    mean_differences: list[float] = Field(description="(joints,) mean over the steps, meters.")
    peaks: list[Peak] = Field(
        description="Moments of greatest mean difference, at least 0.5 s apart, greatest first."
    )

    @classmethod
    def of(cls, found: AlignedClips) -> Alignment:
        """The alignment as the API shows it."""
        return cls(**members_of(found))


def members_of(found: AlignedClips) -> dict[str, Any]:
    """The members of an `Alignment`."""
    return {
        "distance": found.distance,
        "body_lengths": [round(length, _LENGTH_DIGITS) for length in found.body_lengths],
        "path": plain(found.times.round(_TIME_DIGITS)),
        "joints": list(SUN_ROLES),
        "differences": plain(found.differences.round(_LENGTH_DIGITS)),
        "mean_differences": plain(found.differences.mean(axis=0).round(_LENGTH_DIGITS)),
        "peaks": [_peak(found, step) for step in found.peaks.tolist()],
    }


def _peak(found: AlignedClips, step: int) -> Peak:
    joints = found.differences[step]
    return Peak(
        times=plain(found.times[step].round(_TIME_DIGITS)),
        difference=round(float(joints.mean()), _LENGTH_DIGITS),
        joint=SUN_ROLES[int(joints.argmax())],
        joint_difference=round(float(joints.max()), _LENGTH_DIGITS),
    )
