"""The joint angles of a motion, by the best way that its file allows."""

from __future__ import annotations

from dataclasses import dataclass

from app.analysis.angles.clinical_angles import clinical_angles
from app.analysis.angles.from_positions import frames_of_positions
from app.analysis.angles.neutral_pose import frames_of_rotations
from app.analysis.angles.segment_frames import Neutral
from app.motion.motion import Motion
from app.motion.skeleton.animation import Animation
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class JointAngles:
    """degrees: (frames, angles) in the order of `ANGLE_NAMES`, NaN where an angle is not known.
    neutral: where the neutral pose comes from. frame_rate: Hz."""

    degrees: FloatArray
    neutral: Neutral
    frame_rate: float


def angles_of(motion: Motion, animation: Animation | None) -> JointAngles:
    """The joint angles of `motion`.

    animation: the same motion with the rotations of its file, at the same rate; None if the file
    has none.
    """
    if animation is None:
        segments = frames_of_positions(motion)
    else:
        segments = frames_of_rotations(animation, motion.roles)
    degrees = clinical_angles(segments, motion.frames)
    return JointAngles(degrees, segments.neutral, motion.frame_rate)
