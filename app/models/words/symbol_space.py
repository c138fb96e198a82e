"""The motion symbol space: symbols as points with distances like their divergences
(Takano, section 2.1, eqs 2-4).

The distance of two symbols is log1p of their symmetric Kullback-Leibler divergence per frame. In a
small library, all symbols are scaled together. In a larger one, random landmarks are scaled. All
other symbols are placed by their distances to the landmarks, so that the cost grows with N and not
with N squared. New symbols are placed in the same way. Shapes: symbols N, landmarks L, dimensions
d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.words.symbol_arrays import pack_symbols, unpack_symbols
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.hmm.divergence import symmetric_divergences
from app.numerics.hmm.model import GaussianHMM
from app.numerics.mds import metric_mds, place

SYMBOL_SPACE_VERSION = 1

DIMENSIONS = 10
"""Dimensions of the space in the paper (Takano, fig. 3), where the error has converged: one more
lowers it by .1 %. On 501 real clips, one more lowers it by 13 %."""

MAX_WHOLE_LIBRARY = 200
"""Up to this number of symbols, all are landmarks."""

LANDMARKS = 100
"""Number of landmarks of a larger library, at least 2.5 x dimensions. The figures of word
recognition are the same as with all symbols."""

LANDMARKS_PER_DIMENSION = 2.5


@dataclass(frozen=True, slots=True)
class SymbolSpace:
    """A fitted symbol space.

    landmarks: L symbols; points: (L, d) their coordinates, log1p nats per frame.
    """

    landmarks: tuple[GaussianHMM, ...]
    points: FloatArray

    def place(self, symbols: Sequence[GaussianHMM]) -> FloatArray:
        """(N, d) coordinates of `symbols`, in the library or not."""
        if not symbols:
            return np.zeros((0, self.points.shape[1]))
        return self.place_at(symbol_distances(symbols, self.landmarks))

    def place_at(self, distances: FloatArray) -> FloatArray:
        """(N, d) coordinates of symbols with these `symbol_distances` (N, L) to the landmarks."""
        return place(distances, self.points)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = {f"landmark_{name}": a for name, a in pack_symbols(self.landmarks).items()}
        return {**arrays, "points": self.points}, {"version": SYMBOL_SPACE_VERSION}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> SymbolSpace:
        """The space from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != SYMBOL_SPACE_VERSION:
            raise ValueError(f"symbol space of version {meta['version']}")
        prefix = "landmark_"
        packed = {k.removeprefix(prefix): v for k, v in arrays.items() if k.startswith(prefix)}
        return cls(unpack_symbols(packed), arrays["points"])


def fit_symbol_space(
    symbols: Sequence[GaussianHMM], dimensions: int = DIMENSIONS, *, seed: int = 0
) -> SymbolSpace:
    """Fit on `symbols` (N >= 1); deterministic for a seed."""
    (space,) = fit_symbol_spaces(symbols, (dimensions,), seed=seed)
    return space


def fit_symbol_spaces(
    symbols: Sequence[GaussianHMM], dimensions: Sequence[int], *, seed: int = 0
) -> list[SymbolSpace]:
    """Spaces of several numbers of dimensions with the same landmarks, as `fit_symbol_space`."""
    landmarks = tuple(symbols[int(row)] for row in landmark_rows(len(symbols), seed=seed))
    distances = symbol_distances(landmarks, landmarks)
    return [SymbolSpace(landmarks, metric_mds(distances, count)) for count in dimensions]


def possible_dimensions(candidates: Sequence[int], symbols: int) -> tuple[int, ...]:
    """Those of the candidates that the landmarks of so many symbols can place, and the least."""
    landmarks = len(landmark_rows(symbols))
    least = min(candidates)
    return tuple(c for c in candidates if c == least or c * LANDMARKS_PER_DIMENSION <= landmarks)


def landmark_rows(count: int, *, seed: int = 0) -> IntArray:
    """(L,) sorted indices of the landmarks among `count` symbols; all in a small library."""
    rows = np.arange(count)
    if count > MAX_WHOLE_LIBRARY:
        rows = np.sort(np.random.RandomState(seed).permutation(count)[:LANDMARKS])
    return rows


def symbol_distances(left: Sequence[GaussianHMM], right: Sequence[GaussianHMM]) -> FloatArray:
    """(left, right) log1p of the symmetric divergence per frame."""
    return np.asarray(np.log1p(symmetric_divergences(left, right)))
