"""A performance: controls over time, with the true times of its keyposes and beats."""

from __future__ import annotations

from dataclasses import dataclass

from app.demo.controls import Controls
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Performance:
    """One performance of a task.

    times: (frames,) seconds. controls: the curves at these times. keyposes, beats: their times in
    seconds; only dances have them.
    """

    times: FloatArray
    controls: Controls
    keyposes: tuple[float, ...] = ()
    beats: tuple[float, ...] = ()
