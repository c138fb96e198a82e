"""The correlated space of motions and words (Takano, sections 2.2-2.4, eqs 5-19).

CCA projects the symbols' coordinates x and the label vectors y to f and g. C maps words to the
canonical space of motions (eqs 15-19), D maps motions to that of words. The paper's eq. 16,
C = S_FG, solves eq. 15 only if S_G is the identity, and is printed transposed; here both are ridge
regressions. The default measure is the angle, which ranks better on held-out clips than the paper's
Euclidean distance (top-3 words .85 against .75 on 496 real clips); the distance is also available.
Shapes: clips N, words V, dimensions d, k.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.numerics.arrays import FloatArray
from app.numerics.cca import CanonicalPair, fit_cca
from app.numerics.euclidean import distances

CORRELATED_SPACE_VERSION = 1

RIDGE = 0.3
"""Share of the mean variance added to each side's covariance in CCA, C and D. Of .003 to .3, this
is the best on held-out real clips for each number of dimensions (top-3 words .904 for 40; .888 with
.1, .825 with the pseudo-inverse)."""

MIN_CLIPS = 3
"""Labeled clips that a correlated space needs."""


@dataclass(frozen=True, slots=True)
class CorrelatedSpace:
    """A fitted correlated space.

    pair: the canonical projections of x (d) and y (V); words_to_motions: (k, k) C;
    motions_to_words: (k, k) D.
    """

    pair: CanonicalPair
    words_to_motions: FloatArray
    motions_to_words: FloatArray

    def motions(self, points: FloatArray) -> FloatArray:
        """(N, k) f = A'x of symbol coordinates (N, d)."""
        return np.asarray((points - self.pair.x_mean) @ self.pair.a)

    def words(self, labels: FloatArray) -> FloatArray:
        """(N, k) g = B'y of label vectors (N, V)."""
        return np.asarray((labels - self.pair.y_mean) @ self.pair.b)

    def clip_cosines(self, points: FloatArray, query: FloatArray) -> FloatArray:
        """(N,) cosine in -1..1 between each clip's f and C'g of a query's label vector (V,)."""
        return _cosines(self.motions(points), self._query_point(query))[:, 0]

    def single_word_cosines(self, points: FloatArray) -> FloatArray:
        """(N, V) cosine in -1..1 between each clip's f and the C'g of each single word."""
        return _cosines(self.motions(points), self._single_words() @ self.words_to_motions)

    def clip_distances(self, points: FloatArray, query: FloatArray) -> FloatArray:
        """(N,) distance of each clip's f to C'g of a query's label vector (V,), as in the paper."""
        return np.asarray(np.linalg.norm(self.motions(points) - self._query_point(query), axis=1))

    def single_word_distances(self, points: FloatArray) -> FloatArray:
        """(N, V) distance of each clip's f to the C'g of each single word, as in the paper."""
        return distances(self.motions(points), self._single_words() @ self.words_to_motions)

    def word_cosines(self, points: FloatArray) -> FloatArray:
        """(N, V) cosine in -1..1 between D'f of each clip and the g of each single word."""
        return _cosines(self._word_points(points), self._single_words())

    def word_distances(self, points: FloatArray) -> FloatArray:
        """(N, V) distance of D'f of each clip to the g of each single word, as in the paper."""
        return distances(self._word_points(points), self._single_words())

    def _query_point(self, query: FloatArray) -> FloatArray:
        """(1, k) C'g, the label vector (V,) of a query in the canonical space of motions."""
        return np.asarray(self.words(query[None]) @ self.words_to_motions)

    def _word_points(self, points: FloatArray) -> FloatArray:
        """(N, k) D'f, the motions in the canonical space of words."""
        return np.asarray(self.motions(points) @ self.motions_to_words)

    def _single_words(self) -> FloatArray:
        """(V, k) g of the label sets of one word each."""
        return self.words(np.eye(len(self.pair.y_mean)))

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = {
            "x_mean": self.pair.x_mean,
            "y_mean": self.pair.y_mean,
            "a": self.pair.a,
            "b": self.pair.b,
            "correlations": self.pair.correlations,
            "words_to_motions": self.words_to_motions,
            "motions_to_words": self.motions_to_words,
        }
        return arrays, {"version": CORRELATED_SPACE_VERSION}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> CorrelatedSpace:
        """The space from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != CORRELATED_SPACE_VERSION:
            raise ValueError(f"correlated space of version {meta['version']}")
        names = ("x_mean", "y_mean", "a", "b", "correlations")
        pair = CanonicalPair(*(arrays[name] for name in names))
        return cls(pair, arrays["words_to_motions"], arrays["motions_to_words"])


def fit_correlated_space(
    points: FloatArray, labels: FloatArray, *, ridge: float = RIDGE
) -> CorrelatedSpace:
    """Fit on symbol coordinates (n, d) and label vectors (n, V) of the labeled clips.

    ridge: 0 selects the pseudo-inverse, as in the paper. Then the covariance of g is the identity,
    and C is the diagonal matrix of canonical correlations (eq. 16).
    Raises NotEnoughLabels with fewer than MIN_CLIPS clips or without words.
    """
    if len(points) < MIN_CLIPS or labels.shape[1] == 0:
        raise NotEnoughLabels(f"{len(points)} clips have words; {MIN_CLIPS} are needed.")
    pair = fit_cca(points, labels, ridge=ridge)
    motions = (points - pair.x_mean) @ pair.a
    words = (labels - pair.y_mean) @ pair.b
    return CorrelatedSpace(pair, _regress(words, motions, ridge), _regress(motions, words, ridge))


def _cosines(left: FloatArray, right: FloatArray) -> FloatArray:
    """(N, M) cosines of the rows of (N, k) and (M, k); 0 for a row of zeros."""
    lengths = np.linalg.norm(left, axis=1)[:, None] * np.linalg.norm(right, axis=1)
    return np.asarray(left @ right.T / np.maximum(lengths, 1e-12))


def _regress(inputs: FloatArray, outputs: FloatArray, ridge: float) -> FloatArray:
    """(k, k) T minimizing |outputs - inputs T|^2 under the ridge (eq. 15)."""
    normal = inputs.T @ inputs
    if ridge == 0.0:
        return np.asarray(np.linalg.lstsq(inputs, outputs, rcond=None)[0])
    added = ridge * max(float(np.trace(normal)) / len(normal), 1e-12)
    return np.asarray(np.linalg.solve(normal + added * np.eye(len(normal)), inputs.T @ outputs))
