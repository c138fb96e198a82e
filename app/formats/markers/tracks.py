"""The positions of labeled points over time, as a file has them."""

from __future__ import annotations

from dataclasses import dataclass

from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Tracks:
    """The points of a file, labeled or not.

    labels: (points,) as in the file, empty for a point without a label. positions: (frames, points,
    3) float32 in the unit and axes of the file, NaN where a point was not seen. first_frame: the
    number that the file gives to the first frame. frame_rate: Hz, None if the file gives none.
    up_axis: "x", "y" or "z". metres_per_unit: None if the file does not give the unit. outputs:
    labels of results of gait models, which are stored as points but are not markers.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    first_frame: int
    frame_rate: float | None
    up_axis: str
    metres_per_unit: float | None
    cautions: tuple[Caution, ...] = ()
    outputs: frozenset[str] = frozenset()
