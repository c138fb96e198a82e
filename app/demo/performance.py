"""A performance: controls over time, and what is known of it beforehand."""

from __future__ import annotations

from dataclasses import dataclass

from app.demo.controls import Controls
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Performance:
    """times: (frames,) s; controls: as long; keyposes, beats: s, where the task has them."""

    times: FloatArray
    controls: Controls
    keyposes: tuple[float, ...] = ()
    beats: tuple[float, ...] = ()
