"""The best symmetric rank-1 approximation of a volume (Sun 2011, section 3.3, algorithm 1).

A volume A (I, I, K), symmetric in its first two axes, becomes weight * rho o rho o epsilon
with rho (I,) and epsilon (K,) of unit length.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.deadline import check
from app.numerics.arrays import FloatArray

MAX_ITERATIONS = 200
"""Sun saw 5 to 10 suffice on motion volumes; to MIN_CHANGE it takes some 20."""

MIN_CHANGE = 1e-12
"""Stop when lambda changes by less, as a share of it, and rho's square by as little.

Lambda errs with the square of rho, which is then good to a millionth. The paper's 1e-10 is
that of the difference to the volume, which no volume of rank above 1 ever reaches.
"""


@dataclass(frozen=True, slots=True)
class Rank1:
    """weight * primary o primary o secondary.

    weight: lambda >= 0; primary: rho (I,), unit length, sum >= 0; secondary: epsilon (K,),
    unit length; errors: (iterations,) |A - approximation| / |A| after each iteration;
    changes: (iterations,) |lambda - its value before| / lambda (figure 7 shows such a curve).
    """

    weight: float
    primary: FloatArray
    secondary: FloatArray
    errors: FloatArray
    changes: FloatArray
    converged: bool

    @property
    def iterations(self) -> int:
        """How many iterations were made."""
        return len(self.errors)


def symmetric_rank1(
    volume: FloatArray,
    *,
    max_iterations: int = MAX_ITERATIONS,
    smallest_change: float = MIN_CHANGE,
) -> Rank1:
    """Alternating least squares from a constant start, so that it always ends alike.

    `volume`: (I, I, K), symmetric in the first two axes, finite; max_iterations >= 1. An
    all-zero volume gives weight 0 and constant vectors. Convergence is reported, never assumed.
    """
    volume = np.asarray(volume, dtype=np.float64)
    rho, epsilon = _constant(volume.shape[0]), _constant(volume.shape[2])
    size = float(np.linalg.norm(volume))
    if size == 0.0:
        return Rank1(0.0, rho, epsilon, np.zeros(1), np.zeros(1), converged=True)
    weights = [_weight(volume, rho, epsilon)]
    change, converged = np.inf, False
    while not converged and len(weights) <= max_iterations:
        check()
        before = rho
        if change <= smallest_change:
            # Lambda stands still and rho does not: it swings between two vectors, as power
            # iteration does where an eigenvalue has a twin of the other sign.
            rho = _unit(rho + _step(volume, rho, epsilon)[0], otherwise=rho)
        rho, epsilon = _step(volume, rho, epsilon)
        weights.append(_weight(volume, rho, epsilon))
        change = _change(weights)
        converged = max(change, float(np.sum((rho - before) ** 2))) <= smallest_change
    return _settled(volume, rho, np.array(weights), converged)


def _step(
    volume: FloatArray, rho: FloatArray, epsilon: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Both updates of algorithm 1, from the same old vectors as printed."""
    return (
        _unit((volume @ epsilon) @ rho, otherwise=rho),
        _unit(_along_time(volume, rho), otherwise=epsilon),
    )


def _settled(volume: FloatArray, rho: FloatArray, weights: FloatArray, converged: bool) -> Rank1:
    """Fix the sign of rho, and take epsilon and the weight from it (so the weight is >= 0)."""
    rho = rho if rho.sum() >= 0 else -rho
    times = _along_time(volume, rho)
    epsilon = _unit(times, otherwise=_constant(len(times)))
    errors = _relative_errors(weights[1:], float(np.linalg.norm(volume)))
    changes = np.array([_change(weights[:stop]) for stop in range(2, len(weights) + 1)])
    return Rank1(float(times @ epsilon), rho, epsilon, errors, changes, converged)


def _along_time(volume: FloatArray, rho: FloatArray) -> FloatArray:
    """(K,) = A x1 rho x2 rho."""
    rows, columns, frames = volume.shape
    return np.outer(rho, rho).ravel() @ volume.reshape(rows * columns, frames)


def _weight(volume: FloatArray, rho: FloatArray, epsilon: FloatArray) -> float:
    return float(_along_time(volume, rho) @ epsilon)


def _change(weights: Sequence[float] | FloatArray) -> float:
    """Of the last weight against the one before, as a share of it; 0 where it is 0."""
    before, now = weights[-2:]
    return float(abs(now - before) / abs(now)) if now else 0.0


def _relative_errors(weights: FloatArray, size: float) -> FloatArray:
    """From |A - weight * rank-1|^2 = |A|^2 - weight^2, which holds for unit vectors."""
    return np.asarray(np.sqrt(np.maximum(0.0, 1.0 - (weights / size) ** 2)))


def _constant(count: int) -> FloatArray:
    return np.full(count, 1.0 / np.sqrt(max(count, 1)))


def _unit(vector: FloatArray, otherwise: FloatArray) -> FloatArray:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else otherwise
