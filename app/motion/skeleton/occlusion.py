"""Markers that no camera saw for a while: short gaps are filled, long ones are told.

A gap is filled by the cubic spline through all that was seen of the marker, at the ends of
the recording by the nearest frame that was seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import BoolArray, FloatArray

MAX_GAP = 0.25
"""Seconds; a limb turns back within half a second, so that a longer gap may hide it."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Frames from `start` to before `end` in which `marker` was not seen."""

    marker: int
    start: int
    end: int


@dataclass(frozen=True, slots=True)
class Filled:
    """positions: (frames, markers, 3), NaN only in long gaps; frames: how many frames of
    markers were filled; long_gaps: those that were not, by marker and time."""

    positions: FloatArray
    frames: int
    long_gaps: tuple[Gap, ...]


def fill_gaps(positions: FloatArray, frame_rate: float) -> Filled:
    """Fill what is NaN in positions (frames, markers, 3) for up to MAX_GAP seconds."""
    longest = max(1, round(MAX_GAP * frame_rate))
    unseen: BoolArray = np.asarray(np.isnan(positions).any(axis=-1))
    filled = positions.copy()
    long_gaps: list[Gap] = []
    count = 0
    for marker in np.flatnonzero(unseen.any(axis=0)).tolist():
        short = unseen[:, marker].copy()
        for start, end in runs(short):
            if end - start > longest:
                short[start:end] = False
                long_gaps.append(Gap(marker, start, end))
        if short.any() and not unseen[:, marker].all():
            filled[short, marker] = _interpolated(positions[:, marker], unseen[:, marker], short)
            count += int(short.sum())
    return Filled(filled, count, tuple(long_gaps))


def runs(flags: BoolArray) -> list[list[int]]:
    """Start and end (exclusive) of each run of true flags (frames,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [list(run) for run in edges.reshape(-1, 2).tolist()]


def _interpolated(track: FloatArray, unseen: BoolArray, wanted: BoolArray) -> FloatArray:
    """(wanted frames, 3) of a track (frames, 3)."""
    seen = np.flatnonzero(~unseen)
    frames = np.clip(np.flatnonzero(wanted), seen[0], seen[-1])
    if len(seen) < 2:
        return np.repeat(track[seen], len(frames), axis=0)
    return np.asarray(scipy.interpolate.CubicSpline(seen, track[seen].astype(np.float64))(frames))
