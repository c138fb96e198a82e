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
"""Sun reports that 5 to 10 iterations are enough for motion volumes. About 20 reach MIN_CHANGE."""

MIN_CHANGE = 1e-12
"""Iterations stop if the relative change of lambda and the squared change of rho are smaller.

The error of lambda is of the order of the squared error of rho, so rho is then right to a
millionth. The paper's limit, 1e-10, is for the difference to the volume. No volume of a rank above
1 can reach that.
"""


@dataclass(frozen=True, slots=True)
class Rank1:
    """The approximation weight * primary o primary o secondary, and the course of the iterations.

    weight: lambda, 0 or more. primary: rho (I,), of unit length, with a sum of 0 or more.
    secondary: epsilon (K,), of unit length. errors: (iterations,) |A - approximation| / |A|
    after each iteration. changes: (iterations,) |lambda - lambda before| / lambda after each
    iteration (figure 7 shows such a curve). converged: whether MIN_CHANGE was reached.
    """

    weight: float
    primary: FloatArray
    secondary: FloatArray
    errors: FloatArray
    changes: FloatArray
    converged: bool

    @property
    def iterations(self) -> int:
        """The number of iterations."""
        return len(self.errors)


def symmetric_rank1(
    volume: FloatArray,
    *,
    max_iterations: int = MAX_ITERATIONS,
    min_change: float = MIN_CHANGE,
) -> Rank1:
    """The best rank-1 approximation by alternating least squares (algorithm 1).

    volume: (I, I, K), symmetric in its first two axes, finite. max_iterations: 1 or more.
    min_change: see MIN_CHANGE. The start is constant, so the result is deterministic. A
    volume of zeros has weight 0 and constant vectors. If the iterations do not converge, the
    last result is returned with `converged` false.
    """
    volume = np.asarray(volume, dtype=np.float64)
    rho, epsilon = _constant(volume.shape[0]), _constant(volume.shape[2])
    size = float(np.linalg.norm(volume))
    if size == 0.0:
        return Rank1(0.0, rho, epsilon, np.zeros(1), np.zeros(1), converged=True)
    times = _along_time(volume, rho)
    weights = [float(times @ epsilon)]
    change, converged = np.inf, False
    while not converged and len(weights) <= max_iterations:
        check()
        before = rho
        if change <= min_change:
            # Lambda is constant but rho is not: rho alternates between two vectors. Power
            # iteration does so if two eigenvalues differ only in their sign.
            rho = _unit(rho + _stepped(volume, rho, epsilon), otherwise=rho)
            times = _along_time(volume, rho)
        # both updates of algorithm 1, each from the old vectors, as in the paper
        rho, epsilon = _stepped(volume, rho, epsilon), _unit(times, otherwise=epsilon)
        times = _along_time(volume, rho)
        weights.append(float(times @ epsilon))
        change = _change(weights)
        converged = max(change, float(np.sum((rho - before) ** 2))) <= min_change
    return _result(volume, rho, np.array(weights), converged)


def _stepped(volume: FloatArray, rho: FloatArray, epsilon: FloatArray) -> FloatArray:
    """(I,) the next rho."""
    return _unit((volume @ epsilon) @ rho, otherwise=rho)


def _result(volume: FloatArray, rho: FloatArray, weights: FloatArray, converged: bool) -> Rank1:
    """The result, with the sign of rho fixed. Epsilon and the weight follow from rho.

    weights: (iterations + 1,) lambda at the start and after each iteration.
    """
    rho = rho if rho.sum() >= 0 else -rho
    times = _along_time(volume, rho)
    epsilon = _unit(times, otherwise=_constant(len(times)))
    errors = _relative_errors(weights[1:], float(np.linalg.norm(volume)))
    changes = np.array([_change(weights[:stop]) for stop in range(2, len(weights) + 1)])
    return Rank1(float(times @ epsilon), rho, epsilon, errors, changes, converged)


def _along_time(volume: FloatArray, rho: FloatArray) -> FloatArray:
    """(K,) A x_1 rho x_2 rho."""
    rows, columns, frames = volume.shape
    return np.outer(rho, rho).ravel() @ volume.reshape(rows * columns, frames)


def _change(weights: Sequence[float] | FloatArray) -> float:
    """The relative change of the last weight to the one before it; 0 if the last weight is 0."""
    before, now = weights[-2:]
    return float(abs(now - before) / abs(now)) if now else 0.0


def _relative_errors(weights: FloatArray, size: float) -> FloatArray:
    """The errors |A - approximation| / |A|, from |A - approximation|^2 = |A|^2 - weight^2.

    This holds for unit vectors. size: |A|.
    """
    return np.asarray(np.sqrt(np.maximum(0.0, 1.0 - (weights / size) ** 2)))


def _constant(count: int) -> FloatArray:
    return np.full(count, 1.0 / np.sqrt(max(count, 1)))


def _unit(vector: FloatArray, otherwise: FloatArray) -> FloatArray:
    length = float(np.sqrt(vector @ vector))
    return vector / length if length > 0 else otherwise
