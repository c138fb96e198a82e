"""Moments: fingerprints of the liveliest instants of a clip, by which copies of a take are found.

A moment is a local maximum of the speed of the body. Its place comes from the motion alone, so a
copy of the take has the same moments if it is cut, mirrored, noisy, or has another frame rate or
skeleton: each of them can be looked up among the moments of all clips, as audio fingerprints are
(Wang 2003, "An industrial-strength audio search algorithm", looks up pairs of spectral peaks).

The vector of a moment describes the poses about it. In mirrored motion, the first half of the
vector (the symmetric part) stays, and the second half (the antisymmetric part) has the opposite
sign: so mirrored copies are looked up with `mirrored`. The source is our own.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import scipy

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray, IntArray

MAX_MOMENTS = 12
"""Moments of a clip: those with the greatest speed."""

APART = 0.3
"""Seconds between two moments, at least."""

SMOOTHING = 0.08
"""Seconds (standard deviation) by which the speed is smoothed."""

OFFSETS = np.array([-0.4, -0.2, 0.0, 0.2, 0.4])
"""Seconds of the poses about a moment."""

POSE_WEIGHT = 0.5
"""The weight of the mean pose beside the changes. It is small: skeletons of the same take differ,
and that hardly changes how the joints move."""

HALF = 16
"""Numbers of each half of a vector."""

WIDTH = 2 * HALF
MIRRORED_ROLES: tuple[int, ...] = tuple(SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES)
"""The place of each of SUN_ROLES on the other side."""

_FLIP = np.array([-1.0, 1.0, 1.0])
_NUMBERS = (len(OFFSETS) + 1) * len(SUN_ROLES) * 3
_SEED = 20240


def moments(track: BodyTrack) -> FloatArray:
    """(m, 1 + WIDTH) float32, m <= MAX_MOMENTS: the time in seconds and the vector of each moment.

    track: smoothed. The moments are in order of time. A clip has at least one.
    """
    frames = _instants(track)
    times = np.clip(frames[:, None] + np.round(OFFSETS * track.rate), 0, track.frames - 1)
    poses = track.local[times.astype(np.int64)]  # (m, 5, 13, 3)
    mean = poses.mean(axis=1, keepdims=True)
    described = np.concatenate([poses - mean, POSE_WEIGHT * mean], axis=1)
    other = mirrored_poses(described)
    halves = [(described + other) / 2, (described - other) / 2]
    vectors = [
        half.reshape(len(frames), -1) @ basis for half, basis in zip(halves, _bases(), strict=True)
    ]
    return np.column_stack([frames / track.rate, *vectors]).astype(np.float32)


def mirrored(vectors: FloatArray) -> FloatArray:
    """(m, WIDTH) the vectors of the same moments in mirrored motion."""
    signs = np.repeat([1.0, -1.0], HALF).astype(vectors.dtype)
    return np.asarray(vectors * signs)


def mirrored_poses(poses: FloatArray) -> FloatArray:
    """(..., 13, 3) poses in the body frame, mirrored: left is right."""
    return np.asarray(poses[..., MIRRORED_ROLES, :] * _FLIP)


def _instants(track: BodyTrack) -> IntArray:
    """(m,) the frames of the moments."""
    world = (track.positions - track.origin[:1, None]) / track.body_length
    moves = np.gradient(world, axis=0) * track.rate
    speed = np.sqrt(np.square(moves).sum(axis=-1).mean(axis=-1))
    speed = scipy.ndimage.gaussian_filter1d(speed, SMOOTHING * track.rate, mode="nearest")
    peaks, _ = scipy.signal.find_peaks(speed, distance=max(1, round(APART * track.rate)))
    if not len(peaks):
        peaks = np.array([int(np.argmax(speed))])
    fastest = np.argsort(-speed[peaks], kind="stable")[:MAX_MOMENTS]
    return np.sort(peaks[fastest])


@lru_cache(maxsize=1)
def _bases() -> tuple[FloatArray, FloatArray]:
    """Two (_NUMBERS, HALF) fixed random projections; RandomState's stream is frozen."""
    rng = np.random.RandomState(_SEED)
    one, other = (np.linalg.qr(rng.standard_normal((_NUMBERS, HALF)))[0] for _ in range(2))
    return one, other
