"""A recording: a motion as it is in its file, in the file's own unit, axes and frame rate."""

from __future__ import annotations

from dataclasses import dataclass

from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

FRAME_RATES = (1.0, 2000.0)
"""Hz: the smallest and the largest frame rate that a client or a file may give."""


@dataclass(frozen=True, slots=True)
class Caution:
    """A doubt that does not prevent the use of a clip.

    code: for programs. detail: for people. likely: the value that is probably right, if there is
    one (for example a frame rate in Hz). frames: where the doubt is, or is worst, as the first
    frame of the recording and the one after the last; None if it is about the whole. joint: the
    name of the joint or marker that it is about, or of the first of several.
    """

    code: str
    detail: str
    likely: float | None = None
    frames: tuple[int, int] | None = None
    joint: str | None = None


@dataclass(frozen=True, slots=True)
class Recording:
    """What every format reader returns.

    positions: (frames, joints, 3) float32 in the world, in the unit and axes of the file, always
    finite. rotations: (frames, joints, 4) float32 local unit quaternions w x y z; None if the
    format has none (markers). translations: (frames, joints, 3) float32 local translations if they
    change over time (joints of six channels); None means the skeleton's offsets and the motion of
    the root. frame_rate: Hz as declared, None if the file does not give it. up_axis: "x", "y" or
    "z", as declared or as usual in the format. is_up_axis_said: whether the file itself says it, so
    that it is never judged. metres_per_unit: None if the file does not give it. assumed_frame_rate:
    Hz, the usual rate of the format, if the file does not give one and nearly all files agree.
    start_frame: the frames from the start of the file to the first frame of the recording. It has a
    fraction if an animation begins between two frames, and is negative if it begins before 0 s.
    """

    format: str
    skeleton: Skeleton
    positions: FloatArray
    rotations: FloatArray | None
    translations: FloatArray | None
    frame_rate: float | None
    up_axis: str = "y"
    metres_per_unit: float | None = None
    cautions: tuple[Caution, ...] = ()
    assumed_frame_rate: float | None = None
    is_up_axis_said: bool = False
    start_frame: float = 0.0
