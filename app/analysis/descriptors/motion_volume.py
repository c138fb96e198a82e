"""The motion sequence volume and its rank-1 factors (Sun 2011, sections 3 and 4).

The self-similarity matrix of a pose holds the distances between its 13 joints. Stacked over time,
these matrices make a volume (13, 13, frames). Three factors approximate it: lambda, the primary
vector rho (13,) and the secondary vector epsilon (frames,).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.numerics.alignment.cross_correlation import (
    max_contained_cosines,
    max_cross_correlations,
    max_cross_correlations_of_rows,
)
from app.numerics.alignment.dtw import dtw_distances
from app.numerics.arrays import FloatArray
from app.numerics.tensors.rank1 import Rank1, symmetric_rank1

MAX_CROSS_CORRELATION = 3.0
"""The largest value of equation 6: rho counts twice, epsilon once, each at most 1."""


def self_similarity(points: FloatArray, *, q: int = 2, threshold: float = 0.0) -> FloatArray:
    """(frames, joints, joints) self-similarity matrices of `points` (frames, joints, 3).

    Equations 1 and 2: distances by the q-norm, q = 1 or 2, in the unit of `points`. threshold:
    eta of the paper. With eta > 0 the result is 1 where the distance is at most eta, else 0. With
    eta = 0, the paper's choice, the result is the distance. Raises ValueError for another q.
    """
    if q not in (1, 2):
        raise ValueError("q must be 1 or 2")
    # axis by axis: (frames, joints, joints, 3) of a long clip would not fit
    distances: FloatArray = np.zeros((*points.shape[:2], points.shape[1]))
    for axis in np.moveaxis(points, -1, 0):
        distances += np.abs(axis[:, :, None] - axis[:, None]) ** q
    if q == 2:
        np.sqrt(distances, out=distances)
    return (distances <= threshold).astype(np.float64) if threshold > 0 else distances


def motion_volume(track: BodyTrack, *, q: int = 2, threshold: float = 0.0) -> FloatArray:
    """(13, 13, frames) the volume of `track` (equation 3), in body lengths.

    q, threshold: as of `self_similarity`. The joints are in the body frame, so that the 1-norm
    does not depend on the heading.
    """
    return np.moveaxis(self_similarity(track.local, q=q, threshold=threshold), 0, -1)


def decompose(track: BodyTrack, *, q: int = 2, threshold: float = 0.0) -> Rank1:
    """Lambda, rho (13,) and epsilon (frames,) of the volume of `track` (algorithm 1)."""
    return symmetric_rank1(motion_volume(track, q=q, threshold=threshold))


def cross_correlations(
    rho: FloatArray,
    epsilon: FloatArray,
    rhos: FloatArray,
    epsilons: Sequence[FloatArray],
    *,
    normalized: bool = False,
) -> FloatArray:
    """(c,) D_xcorr of equation 6, 0..3, larger for more similar motions; rho counts twice.

    rho: (13,) and epsilon: (n,) of one motion. rhos: (c, 13) and epsilons: c of (m,) of others.

    As printed, D_xcorr depends on the ratio of the lengths: epsilon has length 1 and hardly
    changes, so it is about 1 / sqrt(T) everywhere, and two of T and U > T frames correlate by about
    sqrt(T / U). normalized: instead of this correlation, the largest cosine of the shorter epsilon
    and an equally long part of the longer one, 0..1.
    """
    spatial = max_cross_correlations_of_rows(rho, rhos)
    correlate = max_contained_cosines if normalized else max_cross_correlations
    return 2.0 * spatial + correlate(epsilon, epsilons)


def warping_distances(
    rho: FloatArray, epsilon: FloatArray, rhos: FloatArray, epsilons: Sequence[FloatArray]
) -> FloatArray:
    """(c,) D_dtw of equation 7, smaller for more similar motions; rho counts twice.

    The parameters are those of `cross_correlations`.
    """
    spatial = dtw_distances(rho, list(rhos), per_step=False)
    return 2.0 * spatial + dtw_distances(epsilon, epsilons, per_step=False)


def compression_ratio(frames: Sequence[int], joints: int = 13) -> float:
    """The size of the factors of clips, as a share of the size of their joint positions.

    frames: the length of each clip. Section 5.3: R = m / (3 sum T) + 1 / (3 h) for m clips of T
    frames and h joints; rho is stored once, not twice. Raises ValueError if there are no frames
    or no joints.
    """
    total = sum(frames)
    if total < 1 or joints < 1:
        raise ValueError("there is nothing to compress")
    return len(frames) / (3 * total) + 1 / (3 * joints)
