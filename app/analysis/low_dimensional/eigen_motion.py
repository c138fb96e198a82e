"""Low-dimensional motion: poses as points of a space that few poses span (Perera 2009, section 4).

Some poses of one or several clips (keyposes, or poses at equal times) make an eigen model: their
mean and principal axes. Any motion can then be described by its coordinates along the first K'
axes, and reconstructed from them. Poses are in the body frame (`BodyTrack.local`), in body lengths,
so that persons of different size can be mixed. A reconstructed motion has the place, heading and
size of the original.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from app.motion.frame.body_frame import BodyTrack, turned
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.signs import fix_signs

PAPER_DIMENSIONS = 3
"""The axes of the space in which Perera draws poses and motions (figs 7 to 9). It is also K' of
most of the paper's motions."""

_RELATIVE_FLOOR = 1e-10
"""Axes with a smaller share of the largest singular value hold only rounding errors."""


class Basis(StrEnum):
    """Which poses make the model."""

    KEYPOSE = "keypose"
    """The clips' keyposes (eqs 4 to 8)."""
    UNIFORM = "uniform"
    """Equally many poses of each clip, at equal times (eqs 10 and 11)."""


@dataclass(frozen=True, slots=True)
class EigenModel:
    """The space that K poses of j joints span.

    mean: (j, 3) the mean pose (eq. 4). axes: (r, j, 3), orthonormal, by falling variance, r <= K.
    eigenvalues: (K,) lambda_k of the covariance of the poses, 0 after the r-th.
    """

    mean: FloatArray
    axes: FloatArray
    eigenvalues: FloatArray

    @property
    def poses(self) -> int:
        """K: the number of poses of the model, which is also its largest number of dimensions."""
        return len(self.eigenvalues)

    def variance_kept(self) -> FloatArray:
        """(K,) the share of variance kept for K' = 1..K (rho, eq. 9); 1 if all poses are equal."""
        total = self.eigenvalues.sum()
        if total <= 0:
            return np.ones(self.poses)
        return np.asarray(np.minimum(np.cumsum(self.eigenvalues) / total, 1.0))

    def coordinates(self, poses: FloatArray, dimensions: int) -> FloatArray:
        """(n, dimensions) the coordinates of `poses` (n, j, 3) (eqs 5, 7, 10).

        They are 0 along axes that the model does not have. Raises ValueError if `dimensions` is
        not 1..K.
        """
        self._check(dimensions)
        axes = self.axes[:dimensions]
        found = np.zeros((len(poses), dimensions))
        found[:, : len(axes)] = np.einsum("njx,kjx->nk", poses - self.mean, axes)
        return found

    def poses_at(self, coordinates: FloatArray) -> FloatArray:
        """(n, j, 3) the poses at `coordinates` (n, K') (eqs 6, 8, 11).

        Raises ValueError if K' is not 1..K.
        """
        self._check(coordinates.shape[1])
        axes = self.axes[: coordinates.shape[1]]
        return np.asarray(self.mean + np.einsum("nk,kjx->njx", coordinates[:, : len(axes)], axes))

    def _check(self, dimensions: int) -> None:
        if not 1 <= dimensions <= self.poses:
            raise ValueError(f"dimensions must be from 1 to {self.poses}, found {dimensions}")


def eigen_model(poses: FloatArray) -> EigenModel:
    """The model of `poses` (K, j, 3), by the SVD of their differences from the mean.

    The K-th eigenvalue is 0, because differences from a mean sum to 0. The signs of the axes are
    fixed. Raises ValueError if there is no pose.
    """
    if not len(poses):
        raise ValueError("an eigen model needs at least one pose")
    rows = poses.reshape(len(poses), -1).astype(np.float64)
    mean = rows.mean(axis=0)
    _, values, axes = np.linalg.svd(rows - mean, full_matrices=False)
    kept = int((values > _RELATIVE_FLOOR * max(float(np.abs(rows).max()), values[0])).sum())
    eigenvalues = np.zeros(len(rows))
    eigenvalues[:kept] = values[:kept] ** 2 / len(rows)
    shape = poses.shape[1:]
    return EigenModel(
        mean.reshape(shape), fix_signs(axes[:kept].T).T.reshape(kept, *shape), eigenvalues
    )


def uniform_frames(frames: int, count: int) -> IntArray:
    """(count,) frames at equal times: the middles of `count` equal parts of `frames` frames.

    Raises ValueError if `count` is not 1..frames.
    """
    if not 1 <= count <= frames:
        raise ValueError(f"count must be from 1 to {frames}, found {count}")
    return np.asarray(((np.arange(count) + 0.5) * frames / count).astype(np.int64))


def low_dimensional(model: EigenModel, track: BodyTrack, dimensions: int) -> BodyTrack:
    """`track` reconstructed from its coordinates along the first axes of the model (eqs 7 and 8).

    The place of the hips, the heading and the body length are those of the original. Raises
    ValueError if `dimensions` is not 1..K.
    """
    local = model.poses_at(model.coordinates(track.local, dimensions))
    return BodyTrack(
        positions=_in_world(local, track),
        local=local,
        origin=track.origin,
        heading=track.heading,
        body_length=track.body_length,
        rate=track.rate,
    )


def reconstruction_errors(model: EigenModel, track: BodyTrack) -> FloatArray:
    """(K,) the RMS error of the reconstruction, in meters, for K' = 1..K dimensions.

    The mean is over all frames and all 13 joints.
    """
    away = track.local - model.mean
    along = np.einsum("njx,kjx->nk", away, model.axes)
    # (K,) the squares that each axis explains, summed over frames
    explained = np.zeros(model.poses)
    explained[: along.shape[1]] = np.square(along).sum(axis=0)
    left = np.maximum(np.square(away).sum() - np.cumsum(explained), 0.0)
    return np.asarray(track.body_length * np.sqrt(left / (track.local.shape[0] * away.shape[1])))


def _in_world(local: FloatArray, track: BodyTrack) -> FloatArray:
    return turned(local * track.body_length, track.heading) + track.origin[:, None]
