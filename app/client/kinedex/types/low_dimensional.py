"""Answers: low dimensional. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Array, Record
from kinedex.types.choices import Basis, Fault, JointRole


@dataclass(frozen=True, slots=True)
class EigenPose(Record):
    """A pose of the model.

    time: Seconds from the start of the clip.
    point: Coordinates on the first three axes, body lengths (figs. 7, 8).
    """

    clip_id: str
    time: float
    point: list[float]


@dataclass(frozen=True, slots=True)
class PoseFault(Record):
    """A span of time in which the pose of a joint is implausible.

    start: Seconds.
    worst: Time of the largest excess, seconds.
    beyond: Largest excess over the limit: degrees, or body lengths for in_trunk.
    """

    fault: Fault
    joint: JointRole
    start: float
    end: float
    worst: float
    beyond: float


@dataclass(frozen=True, slots=True)
class ImplausiblePoses(Record):
    """Poses that no body can take (figs. 13, 14), counted in frames at 30 Hz.

    frames: Number of frames with a fault.
    original_frames: The same number for the original motion.
    faults: The first 1,000 faults, in the order of time.
    """

    frames: int
    share: float
    original_frames: int
    original_share: float
    faults: list[PoseFault]


@dataclass(frozen=True, slots=True, eq=False)
class LowDimensional(Record):
    """A low-dimensional motion of the 13 joint roles.

    Its position, heading and size are those of the original motion.

    parents: Index of each joint's parent, -1 for a root.
    positions: (frames, joints, 3), meters, Y up.
    poses: K, the number of poses of the model.
    variance_kept: For K' = 1..K: share of the variance of the model's own poses (eq. 9).
    error: For K' = 1..K, meters: root mean square distance of the joints from the original
    joints, over all frames and the 13 joints.
    eigen_motion: (frames, 3): coordinates of each frame on the first three axes (fig. 9).
    """

    frame_rate: float
    joint_names: list[str]
    parents: list[int]
    positions: Array
    basis: Basis
    dimensions: int
    poses: int
    variance_kept: list[float]
    error: list[float]
    eigen_poses: list[EigenPose]
    implausible: ImplausiblePoses
    eigen_motion: Array
