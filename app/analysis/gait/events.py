"""Foot strikes and foot offs.

The coordinate-based method of Zeni, Richards and Higginson (2008): a foot strikes when it is
farthest ahead of the hips, and leaves the floor when its toes are farthest behind them. "Ahead" is
along the local direction of progress, so a walk may turn. Ankles stand for heels, which most
skeletons do not have. Times lie between frames, at the vertex of a parabola through the three
frames around the extreme.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.gait.walk import SIDES, Walk
from app.numerics.arrays import FloatArray

MIN_REACH = 0.15
"""Leg lengths: the least prominence of an extreme. Smaller ones are no steps."""

MIN_STRIDE_TIME = 0.4
MAX_STRIDE_TIME = 2.5
"""Seconds between two strikes of one foot: from a sprint to a very slow walk."""


@dataclass(frozen=True, slots=True)
class FootEvents:
    """The times (k,) of the strikes and (m,) of the offs of one foot, seconds of the clip."""

    strikes: FloatArray
    offs: FloatArray


def foot_events(walk: Walk) -> dict[str, FootEvents]:
    """The events of the left and the right foot."""
    return {
        side: FootEvents(
            strikes=_extremes(walk, walk.relative(walk.ankles[side])),
            offs=_extremes(walk, -walk.relative(walk.toes[side])),
        )
        for side in SIDES
    }


def _extremes(walk: Walk, ahead: FloatArray) -> FloatArray:
    """(k,) the times of the maxima of `ahead` (n,), meters."""
    known = np.nan_to_num(ahead, nan=0.0)
    peaks, _ = scipy.signal.find_peaks(
        known,
        prominence=MIN_REACH * walk.leg_length,
        distance=max(1, round(MIN_STRIDE_TIME * walk.rate)),
    )
    before, at, after = known[peaks - 1], known[peaks], known[peaks + 1]
    bend = before - 2 * at + after
    shift = np.where(bend < 0, 0.5 * (before - after) / np.where(bend < 0, bend, -1.0), 0.0)
    return np.asarray(walk.start + (peaks + shift) / walk.rate)
