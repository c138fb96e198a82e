"""The best symmetric rank-1 approximation of a volume (Sun 2011, section 3.3, algorithm 1).

A volume A (I, I, K), symmetric in its first two axes, becomes weight * rho o rho o epsilon
with rho (I,) and epsilon (K,) of unit length.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import FloatArray

MAX_ITERATIONS = 200
"""Sun saw 5 to 10 suffice on motion volumes."""

SMALLEST_CHANGE = 1e-10
"""Stop when the relative error changes by less; no volume of rank above 1 reaches error 0."""


@dataclass(frozen=True, slots=True)
class Rank1:
    """weight * primary o primary o secondary.

    weight: lambda >= 0; primary: rho (I,), unit length, sum >= 0; secondary: epsilon (K,),
    unit length; errors: (iterations,) |A - approximation| / |A| after each iteration.
    """

    weight: float
    primary: FloatArray
    secondary: FloatArray
    errors: FloatArray
    converged: bool

    @property
    def iterations(self) -> int:
        """How many iterations were made."""
        return len(self.errors)


def symmetric_rank1(
    volume: FloatArray,
    *,
    max_iterations: int = MAX_ITERATIONS,
    smallest_change: float = SMALLEST_CHANGE,
) -> Rank1:
    """Alternating least squares from a constant start, so that it always ends alike.

    `volume`: (I, I, K), symmetric in the first two axes, finite. An all-zero volume gives
    weight 0 and constant vectors. Convergence is reported, never assumed.
    """
    volume = np.asarray(volume, dtype=np.float64)
    rho, epsilon = _constant(volume.shape[0]), _constant(volume.shape[2])
    size = float(np.linalg.norm(volume))
    if size == 0.0:
        return Rank1(0.0, rho, epsilon, np.zeros(1), converged=True)
    errors: list[float] = []
    converged = False
    while not converged and len(errors) < max_iterations:
        rho, epsilon = _step(volume, rho, epsilon)
        errors.append(_relative_error(_weight(volume, rho, epsilon), size))
        converged = len(errors) > 1 and abs(errors[-1] - errors[-2]) < smallest_change
    return _settled(volume, rho, errors, converged)


def _step(
    volume: FloatArray, rho: FloatArray, epsilon: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Both updates of algorithm 1, from the same old vectors as printed."""
    return (
        _unit((volume @ epsilon) @ rho, otherwise=rho),
        _unit(_along_time(volume, rho), otherwise=epsilon),
    )


def _settled(volume: FloatArray, rho: FloatArray, errors: list[float], converged: bool) -> Rank1:
    """Fix the sign of rho, and take epsilon and the weight from it (so the weight is >= 0)."""
    rho = rho if rho.sum() >= 0 else -rho
    times = _along_time(volume, rho)
    epsilon = _unit(times, otherwise=_constant(len(times)))
    weight = float(times @ epsilon)
    return Rank1(weight, rho, epsilon, np.asarray(errors), converged)


def _along_time(volume: FloatArray, rho: FloatArray) -> FloatArray:
    """(K,) = A x1 rho x2 rho."""
    rows, columns, frames = volume.shape
    return np.outer(rho, rho).ravel() @ volume.reshape(rows * columns, frames)


def _weight(volume: FloatArray, rho: FloatArray, epsilon: FloatArray) -> float:
    return float(_along_time(volume, rho) @ epsilon)


def _relative_error(weight: float, size: float) -> float:
    """From |A - weight * rank-1|^2 = |A|^2 - weight^2, which holds for unit vectors."""
    return float(np.sqrt(max(0.0, 1.0 - (weight / size) ** 2)))


def _constant(count: int) -> FloatArray:
    return np.full(count, 1.0 / np.sqrt(max(count, 1)))


def _unit(vector: FloatArray, otherwise: FloatArray) -> FloatArray:
    length = np.linalg.norm(vector)
    return vector / length if length > 0 else otherwise
