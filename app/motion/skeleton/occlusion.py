"""Fills short gaps of markers that no camera saw for a while, and reports long gaps.

A gap is filled by a cubic spline through all frames in which the marker was seen. At the ends of
the recording it is filled with the position in the nearest frame in which the marker was seen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import BoolArray, FloatArray

MAX_GAP = 0.25
"""Seconds. A limb can move away and back within half a second, and a longer gap may hide this."""


MIN_SENTINEL = 900.0
"""The smallest number that stands for a point that was not seen."""


@dataclass(frozen=True, slots=True)
class Gap:
    """The frames start .. end - 1 in which `marker` was not seen."""

    marker: int
    start: int
    end: int

    @property
    def frames(self) -> tuple[int, int]:
        """The first frame, and the one after the last."""
        return self.start, self.end


@dataclass(frozen=True, slots=True)
class Filled:
    """Markers with filled gaps.

    positions: (frames, markers, 3), NaN only in long gaps. long_gaps: the gaps that were not
    filled, by marker and time.
    """

    positions: FloatArray
    long_gaps: tuple[Gap, ...]


def fill_gaps(positions: FloatArray, frame_rate: float) -> Filled:
    """Fill the gaps (NaN) of at most MAX_GAP seconds in `positions` (frames, markers, 3).

    frame_rate: Hz. The input is not changed.
    """
    longest = max(1, round(MAX_GAP * frame_rate))
    unseen = hidden(positions)
    filled = positions.copy()
    long_gaps: list[Gap] = []
    for marker in np.flatnonzero(unseen.any(axis=0)).tolist():
        short = unseen[:, marker].copy()
        for start, end in runs(short):
            if end - start > longest:
                short[start:end] = False
                long_gaps.append(Gap(marker, start, end))
        if short.any() and not unseen[:, marker].all():
            filled[short, marker] = _interpolated(positions[:, marker], unseen[:, marker], short)
    return Filled(filled, tuple(long_gaps))


def longest_gap(unseen: BoolArray) -> Gap | None:
    """The longest run of true values in `unseen` (frames, markers); of several the first one."""
    gaps = [
        Gap(marker, start, end)
        for marker in np.flatnonzero(unseen.any(axis=0)).tolist()
        for start, end in runs(unseen[:, marker])
    ]
    return max(gaps, key=lambda gap: gap.end - gap.start, default=None)


def hidden(positions: FloatArray) -> BoolArray:
    """(frames, markers) whether a marker was not seen; positions: (frames, markers, 3)."""
    x, y, z = np.moveaxis(positions, -1, 0)
    return np.asarray(np.isnan(x + y + z))


def without_sentinels(positions: FloatArray) -> FloatArray:
    """The positions with NaN where all three coordinates are one large number, such as 9999.99.

    Programs write such numbers for points that were not seen. No point is there by chance.
    """
    x, y, z = np.moveaxis(positions, -1, 0)
    same = x == y
    if not same.any():
        return positions
    with np.errstate(invalid="ignore"):
        same &= (x == z) & (np.abs(x) >= MIN_SENTINEL)
    if not same.any():
        return positions
    seen = positions.copy()
    seen[same] = np.nan
    return seen


def runs(flags: BoolArray) -> list[list[int]]:
    """The start and the end (exclusive) of each run of true values in `flags` (frames,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [list(run) for run in edges.reshape(-1, 2).tolist()]


def _interpolated(track: FloatArray, unseen: BoolArray, mask: BoolArray) -> FloatArray:
    """(masked frames, 3) `track` (frames, 3) interpolated at the frames of `mask`."""
    seen = np.flatnonzero(~unseen)
    frames = np.clip(np.flatnonzero(mask), seen[0], seen[-1])
    if len(seen) < 2:
        return np.repeat(track[seen], len(frames), axis=0)
    return np.asarray(scipy.interpolate.CubicSpline(seen, track[seen].astype(np.float64))(frames))
