"""How well one clip lies on another: the best shift in time, and what is left of a difference.

Both are the stored features at 10 Hz (`frame_features`). All shifts are compared at once: the sum
of the squared differences over an overlap is |x|^2 + |y|^2 - 2 x.y, where the products of all
shifts are one convolution, and the squares are running sums. The best shift is then refined to a
fraction of a frame, because a cut begins at any time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.descriptors.frame_features import (
    FEATURES,
    POSITIONS,
    TRAVEL,
    TRAVEL_WEIGHT,
    WARPING_RATE,
)
from app.analysis.descriptors.moments import mirrored_poses
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.resampling import sample_at
from app.numerics.arrays import FloatArray, IntArray

MIN_OVERLAP = 0.8
"""The share of the shorter clip that an overlap covers at least."""

MIN_FRAMES = 4
"""Frames of the shortest overlap."""

MIN_SMOOTHED = 12
"""Frames of the shortest clip that is smoothed."""

HOPELESS = 0.7
"""A whole shift with a larger distance is not refined: no fraction of a frame makes up for it."""

STEPS = (0.5, 0.25, 0.125, 0.0625)
"""Frames by which the shift is refined, one after the other."""

TRAVEL_SHARE = 0.1
"""The weight of the hips' velocity and the yaw rate beside the positions."""

SMOOTHING, EDGE = 1.5, 2
"""Frames (standard deviation) of a further smoothing: noise has no place in a comparison, and what
differs between takes is slow. Frames at each end, which it changes, are left out."""

LAG, MIN_LAGS = 5, 3
"""Frames after which noise is forgotten, and lags of the shortest overlap whose drift is known."""

STILL = 0.02
"""Body lengths that a joint of a moving body leaves its mean at least. With less, the noise of two
clips at rest would count as a difference of their movement."""


@dataclass(frozen=True, slots=True)
class Overlay:
    """The best shift of a clip along another.

    shift: seconds of the first clip at which the second one begins; may be negative. seconds: the
    length of the overlap. distance: what differs, as a share of what moves: the root of the squared
    differences over the squared movements of both clips, 0 for the same movement and about 1 for
    unrelated ones; the mean poses of the overlap do not count. offset: the difference of the mean
    poses, body lengths. drift: how much of the difference is still there LAG later (its
    autocorrelation): near 0 for noise, near 1 if the bodies move differently or unknown.
    """

    shift: float
    seconds: float
    distance: float
    offset: float
    drift: float = 1.0


def mirrored_features(features: FloatArray) -> FloatArray:
    """(m, 82) the features of mirrored motion."""
    found = np.array(features)
    for first in (0, POSITIONS.stop):
        part = slice(first, first + POSITIONS.stop)
        poses = features[:, part].reshape(len(features), -1, 3)
        found[:, part] = mirrored_poses(poses).reshape(len(features), -1)
    found[:, [TRAVEL.start, FEATURES - 1]] *= -1  # to the left, and turning to the left
    return found


def overlay(one: FloatArray, other: FloatArray) -> Overlay | None:
    """The best overlay of two clips, features (n, 82) and (m, 82); None if they are too short."""
    is_long = min(len(one), len(other)) >= MIN_SMOOTHED
    x, y = (_compared(features, is_long=is_long) for features in (one, other))
    if min(len(x), len(y)) < MIN_FRAMES:
        return None
    shortest = max(MIN_FRAMES, int(np.ceil(MIN_OVERLAP * min(len(x), len(y)))))
    shift = float(_best_shift(x, y, shortest))
    best = _difference(x, y, shift, shortest)
    for step in STEPS if best is not None and best[0] < HOPELESS else ():
        for tried in (shift - step, shift + step):
            found = _difference(x, y, tried, shortest)
            if found is not None and (best is None or found[0] < best[0]):
                best, shift = found, tried
    if best is None:
        return None
    distance, offset, frames = best
    frames += 2 * EDGE * is_long
    drift = _drift(x, y, shift)
    return Overlay(shift / WARPING_RATE, frames / WARPING_RATE, distance, offset, drift)


def _compared(features: FloatArray, *, is_long: bool) -> FloatArray:
    """(k, 43) what is compared of features (n, 82): positions, the hips' velocity and turns.

    is_long: whether they are smoothed, which takes EDGE frames away at each end.
    """
    travel = features[:, TRAVEL] * (TRAVEL_SHARE / TRAVEL_WEIGHT)
    both = np.hstack([features[:, POSITIONS], travel]).astype(np.float64)
    if not is_long:
        return both
    return np.asarray(scipy.ndimage.gaussian_filter1d(both, SMOOTHING, axis=0)[EDGE:-EDGE])


def _best_shift(x: FloatArray, y: FloatArray, shortest: int) -> int:
    """The whole shift with the least distance."""
    size = scipy.fft.next_fast_len(len(x) + len(y), real=True)
    center = x.mean(axis=0)  # differences of small numbers keep more digits
    x, y = x - center, y - center
    spectra = np.fft.rfft(x, size, axis=0) * np.fft.rfft(y, size, axis=0).conj()
    products = np.fft.irfft(spectra.sum(axis=1), size)
    shifts = np.arange(shortest - len(y), len(x) - shortest + 1)
    first, stop = np.maximum(shifts, 0), np.minimum(shifts + len(y), len(x))
    frames = stop - first
    # (s, 43) sums and (s,) sums of squares of each overlap, from running sums
    own, own_squares = _running(x, first, stop)
    others, other_squares = _running(y, first - shifts, stop - shifts)
    squares = own_squares + other_squares
    left = squares - 2 * products[shifts] - np.square(own - others).sum(axis=1) / frames
    moved = squares - (np.square(own).sum(axis=1) + np.square(others).sum(axis=1)) / frames
    return int(shifts[np.argmin(_relative(left, moved, frames))])


def _running(z: FloatArray, first: IntArray, stop: IntArray) -> tuple[FloatArray, FloatArray]:
    """The sums (s, d) and the sums of all squares (s,) of the frames first .. stop - 1 of z."""
    sums = np.concatenate([np.zeros((1, z.shape[1])), np.cumsum(z, axis=0)])
    squares = np.concatenate([[0.0], np.cumsum(np.square(z).sum(axis=1))])
    return sums[stop] - sums[first], squares[stop] - squares[first]


def _relative(left: FloatArray, moved: FloatArray, frames: IntArray) -> FloatArray:
    """The distance of `Overlay` from sums of squares over overlaps of so many frames."""
    rest = 2 * len(SUN_ROLES) * STILL**2 * frames
    return np.asarray(np.sqrt(np.maximum(left, 0.0) / (np.maximum(moved, 0.0) + rest)))


def _laid(x: FloatArray, y: FloatArray, shift: float) -> tuple[FloatArray, FloatArray]:
    """The frames (f, 43) of both clips in their overlap at a shift in frames."""
    first = max(0, int(np.ceil(shift)))
    stop = min(len(x), int(np.floor(shift + len(y) - 1)) + 1)
    if stop <= first:
        return x[:0], y[:0]
    return x[first:stop], sample_at(y, np.arange(first, stop) - shift)


def _drift(x: FloatArray, y: FloatArray, shift: float) -> float:
    """The drift of `Overlay`; 1 for an overlap that is too short to tell."""
    a, b = _laid(x, y, shift)
    if len(a) < MIN_LAGS * LAG:
        return 1.0
    left = a - b
    left -= left.mean(axis=0)
    same = np.square(left).sum()
    later = (left[LAG:] * left[:-LAG]).sum() * len(left) / (len(left) - LAG)
    return float(later / max(float(same), 1e-12))


def _difference(
    x: FloatArray, y: FloatArray, shift: float, shortest: int
) -> tuple[float, float, int] | None:
    """Distance, offset and frames of the overlap at a shift in frames, see `Overlay`."""
    a, b = _laid(x, y, shift)
    frames = len(a)
    if frames < shortest - 1:
        return None
    means = a.mean(axis=0), b.mean(axis=0)
    gap = means[0] - means[1]
    offset = float(np.sqrt(np.square(gap[POSITIONS]).sum() / len(SUN_ROLES)))
    moved = np.square(a - means[0]).sum() + np.square(b - means[1]).sum()
    left = np.square(a - b - gap).sum()
    distance = float(_relative(left, moved, np.asarray(frames)))
    return distance, offset, frames
