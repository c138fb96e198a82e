"""Words for motions and motions for words in a correlated space, as probabilities (Takano).

There are two modes. "cca" is ours: a ridge, angles, and as many dimensions of the symbol space as
held-out words ask for. "printed" is the paper's: the pseudo-inverse, Euclidean distances, and its
10 dimensions. Both give scores by calibrations on held-out clips (cosine_calibration).
Shapes: clips N, words V, dimensions d.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.words.correlated_space import RIDGE, CorrelatedSpace, fit_correlated_space
from app.models.words.cosine_calibration import CosineCalibration, Cosines, calibrate_cosines
from app.models.words.symbol_space import DIMENSIONS
from app.numerics.arrays import FloatArray

CCA, PRINTED = "cca", "printed"
"""The modes."""
RIDGES = {CCA: RIDGE, PRINTED: 0.0}

CANDIDATES = (DIMENSIONS, 20, 40)
"""Numbers of dimensions among which the mode "cca" chooses. On 498 real clips 40 are chosen; held
out, 10, 20 and 40 dimensions reach .884, .888, .904 for top-3 words, .207, .282, .338 for F of a
word, and .348, .381, .443 for MAP of label sets; 60 add nothing (.906, .354, .438)."""

Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, slots=True)
class CorrelatedWords:
    """A correlated space and its calibrations.

    mode: CCA or PRINTED; to_clips, to_words: the calibrations of closeness from words to clips
    and from clips to words (Takano, sections 2.3 and 2.4).
    """

    mode: str
    space: CorrelatedSpace
    to_clips: CosineCalibration
    to_words: CosineCalibration

    def clip_distances(self, points: FloatArray, query: FloatArray) -> FloatArray:
        """(N,) distances of clips at symbol coordinates (N, d) from a query's label vector (V,).

        They are 1 - cosine, 0..2, in the mode CCA, and Euclidean in the mode PRINTED.
        """
        if self.mode == PRINTED:
            return self.space.clip_distances(points, query)
        return 1.0 - self.space.clip_cosines(points, query)

    def clip_scores(self, distances: FloatArray, shares: FloatArray | float) -> FloatArray:
        """(N,) probabilities of `clip_distances` (N,); shares: of clips that have the words."""
        closeness = -distances if self.mode == PRINTED else 1.0 - distances
        return self.to_clips.probabilities(closeness, shares)

    def word_scores(self, points: FloatArray) -> FloatArray:
        """(N, V) probability that each clip at symbol coordinates (N, d) has each word."""
        return self.to_words.of_words(_WORDS[self.mode](self.space, points))

    def to_arrays(self) -> tuple[Arrays, dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays: Arrays = {}
        meta: dict[str, Any] = {"mode": self.mode}
        for part in _PARTS:
            own, meta[part] = getattr(self, part).to_arrays()
            arrays |= {f"{part}.{name}": array for name, array in own.items()}
        return arrays, meta

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> CorrelatedWords:
        """The record from the result of `to_arrays`. Raises ValueError on another version."""
        own: dict[str, Arrays] = {part: {} for part in _PARTS}
        for name, array in arrays.items():
            part, rest = name.split(".", 1)
            own[part][rest] = array
        return cls(
            meta["mode"],
            CorrelatedSpace.from_arrays(own["space"], meta["space"]),
            CosineCalibration.from_arrays(own["to_clips"], meta["to_clips"]),
            CosineCalibration.from_arrays(own["to_words"], meta["to_words"]),
        )


_PARTS = ("space", "to_clips", "to_words")
_CLIPS: Mapping[str, Cosines] = {
    CCA: CorrelatedSpace.single_word_cosines,
    PRINTED: lambda space, points: -space.single_word_distances(points),
}
_WORDS: Mapping[str, Cosines] = {
    CCA: CorrelatedSpace.word_cosines,
    PRINTED: lambda space, points: -space.word_distances(points),
}
"""Closeness (N, V) of clips and single words, higher if closer, by mode."""


def fit_correlated_words(
    points: FloatArray, labels: FloatArray, groups: Sequence[str], mode: str, *, seed: int = 0
) -> CorrelatedWords:
    """Fit on symbol coordinates (n, d) and label vectors (n, V) of the labeled clips.

    groups: n, clips of one group are held out together. Raises NotEnoughLabels with too few.
    """
    ridge = RIDGES[mode]
    return CorrelatedWords(
        mode,
        fit_correlated_space(points, labels, ridge=ridge),
        calibrate_cosines(points, labels, groups, _CLIPS[mode], ridge=ridge, seed=seed).curve,
        calibrate_cosines(points, labels, groups, _WORDS[mode], ridge=ridge, seed=seed).curve,
    )


def dimension_losses(
    points: Mapping[int, FloatArray], labels: FloatArray, groups: Sequence[str], *, seed: int = 0
) -> dict[int, float]:
    """The mean log loss of single words on held-out clips, by the number of dimensions.

    points: (n, d) symbol coordinates by their number of dimensions d.
    """
    return {
        count: calibrate_cosines(rows, labels, groups, _CLIPS[CCA], seed=seed).loss
        for count, rows in points.items()
    }


def chosen_dimensions(losses: Mapping[int, float]) -> int:
    """The number of dimensions with the smallest loss; the smallest number of equal ones."""
    return min(losses, key=lambda count: (losses[count], count))
