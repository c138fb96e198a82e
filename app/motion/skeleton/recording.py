"""A recording: a motion as its file tells it, in the file's own unit, axes and rate."""

from __future__ import annotations

from dataclasses import dataclass

from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

FRAME_RATES = (1.0, 2000.0)
"""Hz, the least and the most, whether a client says it or a file."""


@dataclass(frozen=True, slots=True)
class Caution:
    """A doubt that does not stop a clip: `code` for machines, `detail` for people.

    `likely` is the value that we think right where there is one (a frame rate in Hz).
    """

    code: str
    detail: str
    likely: float | None = None


@dataclass(frozen=True, slots=True)
class Recording:
    """What every format reader returns.

    positions: (frames, joints, 3) float32, world, file unit and axes, always finite;
    rotations: (frames, joints, 4) float32 local unit quaternions w x y z, or None where
    the format has none (markers); translations: (frames, joints, 3) float32 local
    translations where they move over time (six-channel joints), else None, meaning the
    skeleton's offsets plus the root's motion; root_translations follow from positions.
    frame_rate: Hz as declared, None if the file does not say; up_axis: "x", "y" or "z";
    metres_per_unit: None if the file does not say; assumed_frame_rate: Hz that the format's
    files usually have, where the file does not say and nearly all are alike.
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
