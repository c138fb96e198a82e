"""Multidimensional scaling: points from their distances (Takano, eqs 3-4).

Classical scaling gives the start. Then the paper's error T is minimized (eq. 3: the s-stress of
Takane, each pair weighted by 1 / 4 D^2). We use L-BFGS instead of the paper's Newton-Raphson,
because it needs no Hessian of all points. A new point is placed alone, relative to fixed
landmarks, with the same error. Shapes: points N, landmarks L, dimensions d.

scikit-learn minimizes only the raw stress (app.numerics.smacof). That leaves a larger error T:
.229 for each pair against .216 here, for 166 real symbols in 10 dimensions, in the same time.
"""

from __future__ import annotations

import numpy as np
import scipy

from app.numerics.arrays import FloatArray
from app.numerics.euclidean import squared_distances
from app.numerics.signs import fix_signs

REFINING_STEPS = 200
"""The largest number of L-BFGS iterations. On real libraries the error settles long before."""

PLACING_STEPS = 20
"""The number of Levenberg-Marquardt steps for a new point."""

MIN_SHARE = 1e-3
"""The smallest distance, as a share of the mean distance. Eq. 3 divides by distances."""

_BLOCK = 2000
"""The number of points that are placed at once. It bounds the memory to _BLOCK * L * d floats."""


def classical_mds(distances: FloatArray, dimensions: int) -> FloatArray:
    """(N, d) coordinates by double centering of the squared `distances` (N, N), symmetric.

    dimensions: d, the number of columns. Columns beyond the rank are zero. In each column the
    entry of largest magnitude is positive, so the result is deterministic. scikit-learn's
    ClassicalMDS gives the same points in 1.4 to 2.3 times the time (4.1 ms against 3.0 for 200
    points), takes half a second to load, and has no column for a dimension beyond N.
    """
    squares = np.asarray(distances, dtype=np.float64) ** 2
    centered = squares - squares.mean(axis=0) - squares.mean(axis=1)[:, None] + squares.mean()
    values, vectors = np.linalg.eigh(-0.5 * centered)
    order = np.argsort(values)[::-1][:dimensions]
    points = fix_signs(vectors[:, order]) * np.sqrt(np.maximum(values[order], 0.0))
    return np.pad(points, ((0, 0), (0, dimensions - len(order))))


def metric_mds(distances: FloatArray, dimensions: int) -> FloatArray:
    """(N, d) coordinates that minimize eq. 3 for `distances` (N, N), symmetric, of any unit.

    The coordinates have the unit of the distances. Fewer than three points keep their classical
    coordinates.
    """
    start = classical_mds(distances, dimensions)
    if len(start) < 3:
        return start
    squares = _floored(distances) ** 2
    result = scipy.optimize.minimize(
        lambda flat: _stress_and_slope(flat.reshape(start.shape), squares),
        start.ravel(),
        jac=True,
        method="L-BFGS-B",
        options={"maxiter": REFINING_STEPS},
    )
    return np.asarray(result.x.reshape(start.shape))


def stress(points: FloatArray, distances: FloatArray) -> float:
    """The error T of eq. 3 of `points` (N, d) for `distances` (N, N), summed over pairs i < j."""
    return _stress_and_slope(points, _floored(distances) ** 2)[0]


def place(distances: FloatArray, landmarks: FloatArray) -> FloatArray:
    """(N, d) coordinates of new points, from their `distances` (N, L) to `landmarks` (L, d).

    Each point is placed alone; N may be 0. The start is the triangulation of landmark MDS (de
    Silva and Tenenbaum 2004). Levenberg-Marquardt steps then lower the error of eq. 3.
    """
    blocks = [
        _place_block(distances[first : first + _BLOCK], landmarks)
        for first in range(0, len(distances), _BLOCK)
    ]
    return np.concatenate([np.zeros((0, landmarks.shape[1])), *blocks])


def _floored(distances: FloatArray) -> FloatArray:
    """The distances, of any shape, with MIN_SHARE of their mean as the smallest."""
    targets = np.asarray(distances, dtype=np.float64)
    return np.maximum(targets, max(MIN_SHARE * float(targets.mean()), 1e-12))


def _stress_and_slope(points: FloatArray, squares: FloatArray) -> tuple[float, FloatArray]:
    """The error T and its gradient (N d,); squares: (N, N) the given squared distances."""
    excess = squares - squared_distances(points, points)
    np.fill_diagonal(excess, 0.0)
    pull = excess / squares  # (N, N); eq. 3 divides by 4 D^2
    slope = pull @ points - pull.sum(axis=1)[:, None] * points
    return float((excess * pull).sum() / 8.0), slope.ravel()


def _place_block(distances: FloatArray, landmarks: FloatArray) -> FloatArray:
    """(N, d) as `place`, for some of the points."""
    targets = _floored(distances)
    points = _triangulate(targets, landmarks)
    damping = np.full(len(points), 1e-2)
    residuals, slopes = _misfit(points, targets, landmarks)
    for _ in range(PLACING_STEPS):
        moved = points + _damped_step(residuals, slopes, damping)
        new_residuals, new_slopes = _misfit(moved, targets, landmarks)
        is_better = (new_residuals**2).sum(axis=1) < (residuals**2).sum(axis=1)
        points[is_better] = moved[is_better]
        residuals[is_better], slopes[is_better] = new_residuals[is_better], new_slopes[is_better]
        damping *= np.where(is_better, 0.3, 5.0)  # a worse step is dropped, and the next is shorter
    return points


def _triangulate(targets: FloatArray, landmarks: FloatArray) -> FloatArray:
    """(N, d) the least-squares points for the distances `targets` (N, L) to the landmarks."""
    center = landmarks.mean(axis=0)
    spread = landmarks - center
    # |x - l|^2 = |x|^2 - 2 x.l + |l|^2: differences over landmarks are linear in x
    products = (spread**2).sum(axis=1) - targets**2
    products = products - products.mean(axis=1, keepdims=True)  # removes |x|^2, which is unknown
    return np.asarray(0.5 * products @ np.linalg.pinv(spread, rcond=1e-6).T + center)


def _misfit(
    points: FloatArray, targets: FloatArray, landmarks: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The residuals (N, L) and their derivatives (N, L, d) by the coordinates of `points`.

    targets: (N, L) the given distances. The squared residuals sum to the error of eq. 3.
    """
    offsets = points[:, None] - landmarks
    residuals = (targets**2 - (offsets**2).sum(axis=2)) / (2.0 * targets)
    return residuals, -offsets / targets[:, :, None]


def _damped_step(residuals: FloatArray, slopes: FloatArray, damping: FloatArray) -> FloatArray:
    """(N, d) the Levenberg-Marquardt step of each point; damping: (N,)."""
    normal = slopes.transpose(0, 2, 1) @ slopes  # (N, d, d)
    scale = np.trace(normal, axis1=1, axis2=2) / normal.shape[1] + 1e-12
    normal += (damping * scale)[:, None, None] * np.eye(normal.shape[1])
    slope = slopes.transpose(0, 2, 1) @ residuals[:, :, None]
    return np.asarray(-np.linalg.solve(normal, slope)[:, :, 0])
