"""The default word model: from a clip's statistics and signs of movement to scores of its words.

Two kernel ridge regressions answer, and their mean is the output. One reads the statistics of the
motion symbol (app.analysis.symbols.channels), which know the clip in detail; the other reads the
signs of movement (app.analysis.descriptors.movement_signs), which are the same in any recording. A
clip of another source is far from all clips that the first one learned from, so the second one
decides there. Held out on 498 real clips, the mean has a Brier score of .0193 (statistics alone
.0197, signs alone .0209); words of one source that are asked of another one have a mean log loss
of .355 (.379, .383). A weight that was fitted on held-out persons was no better than the mean.
Outputs become probabilities in app.models.words.calibration. Shapes: clips N, inputs p, words V.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.numerics.arrays import FloatArray
from app.numerics.euclidean import squared_distances
from app.numerics.kernel_ridge import KernelRidge, fit_kernel_ridge, refit_kernel_ridge

WORD_MODEL_VERSION = 2

STATISTICS = 131
"""Columns of the input that are statistics; all after them are signs, which may be missing."""

MAX_DEVIATIONS = 10.0
"""Limit of standardized inputs, so that one broken clip cannot distort the kernel."""

NEAREST_AT_ONCE = 1000
"""Clips whose distances are computed at once. It bounds the memory."""

Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, slots=True)
class Regression:
    """mean, scale: (p,) standardize the inputs; ridge: maps them to V outputs."""

    mean: FloatArray
    scale: FloatArray
    ridge: KernelRidge

    def standardize(self, rows: FloatArray) -> FloatArray:
        """(N, p) the deviations of `rows` from the mean, limited to +-MAX_DEVIATIONS."""
        deviations = (np.asarray(rows, dtype=np.float64) - self.mean) / self.scale
        return np.clip(deviations, -MAX_DEVIATIONS, MAX_DEVIATIONS)

    def outputs(self, rows: FloatArray) -> FloatArray:
        """(N, V) outputs for `rows` (N, p)."""
        return self.ridge.predict(self.standardize(rows))

    def refit(self, rows: FloatArray, labels: FloatArray, seed: int) -> Regression:
        """Fit on some (n >= 1) of the rows, with this kernel and these scales."""
        ridge = refit_kernel_ridge(self.ridge, self.standardize(rows), labels, seed=seed)
        return Regression(self.mean, self.scale, ridge)


@dataclass(frozen=True, slots=True)
class WordModel:
    """parts: the regression from statistics, and the one from signs if there are any."""

    parts: tuple[Regression, ...]

    def outputs(self, inputs: FloatArray) -> FloatArray:
        """(N, V) outputs for clips with `inputs` (N, p): about 0..1, but not limited to it."""
        found = [part.outputs(rows) for part, rows in zip(self.parts, split(inputs), strict=True)]
        return np.asarray(np.mean(found, axis=0))

    def predict(self, inputs: FloatArray) -> FloatArray:
        """(N, V) the outputs, limited to 0..1."""
        return np.clip(self.outputs(inputs), 0.0, 1.0)

    def refit(self, inputs: FloatArray, labels: FloatArray, *, seed: int = 0) -> WordModel:
        """Fit on some (n >= 1) of the clips, with the kernels and scales of this model."""
        pairs = zip(self.parts, split(inputs), strict=True)
        return WordModel(tuple(part.refit(rows, labels, seed) for part, rows in pairs))

    def nearest(self, inputs: FloatArray) -> FloatArray:
        """(N,) distance of each clip's statistics to the nearest clip that taught the model."""
        part, rows = self.parts[0], split(inputs)[0]
        centers = part.ridge.centers
        squares = [
            squared_distances(part.standardize(block), centers).min(axis=1)
            for block in _blocks(rows)
        ]
        return np.asarray(np.sqrt(np.concatenate([np.zeros(0), *squares])))

    def to_arrays(self) -> tuple[Arrays, dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays: Arrays = {}
        kernels = []
        for number, part in enumerate(self.parts):
            own = {
                "mean": part.mean,
                "scale": part.scale,
                "centers": part.ridge.centers,
                "weights": part.ridge.weights,
                "offset": part.ridge.offset,
            }
            arrays |= {f"{name}_{number}": array for name, array in own.items()}
            kernels.append({"width": part.ridge.width, "penalty": part.ridge.penalty})
        return arrays, {"version": WORD_MODEL_VERSION, "kernels": kernels}

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> WordModel:
        """The model from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != WORD_MODEL_VERSION:
            raise ValueError(f"word model of version {meta['version']}")
        parts = []
        for number, kernel in enumerate(meta["kernels"]):
            mean, scale, centers, weights, offset = (
                arrays[f"{name}_{number}"]
                for name in ("mean", "scale", "centers", "weights", "offset")
            )
            ridge = KernelRidge(centers, weights, offset, kernel["width"], kernel["penalty"])
            parts.append(Regression(mean, scale, ridge))
        return cls(tuple(parts))


def fit_word_model(inputs: FloatArray, labels: FloatArray, *, seed: int = 0) -> WordModel:
    """Fit on `inputs` (n, p) and label vectors (n, V) of the labeled clips.

    inputs: STATISTICS statistics, and after them the signs, if there are any. Raises
    NotEnoughLabels without a clip or without a word.
    """
    if labels.shape[0] == 0 or labels.shape[1] == 0:
        raise NotEnoughLabels("No clip has words.")
    return WordModel(tuple(_fit(rows, labels, seed) for rows in split(inputs)))


def split(inputs: FloatArray) -> tuple[FloatArray, ...]:
    """Statistics (N, <= STATISTICS), and signs if there are any, of `inputs` (N, p)."""
    parts = inputs[:, :STATISTICS], inputs[:, STATISTICS:]
    return parts if parts[1].shape[1] else parts[:1]


def _fit(rows: FloatArray, labels: FloatArray, seed: int) -> Regression:
    rows = np.asarray(rows, dtype=np.float64)
    mean, scale = rows.mean(axis=0), rows.std(axis=0)
    scale = np.where(scale > 1e-6, scale, 1.0)  # a column that never varies carries no information
    deviations = np.clip((rows - mean) / scale, -MAX_DEVIATIONS, MAX_DEVIATIONS)
    return Regression(mean, scale, fit_kernel_ridge(deviations, labels, seed=seed))


def _blocks(rows: FloatArray) -> list[FloatArray]:
    return [rows[first : first + NEAREST_AT_ONCE] for first in range(0, len(rows), NEAREST_AT_ONCE)]


def clip_cosines(predicted: FloatArray, query: FloatArray) -> FloatArray:
    """(N,) cosine in 0..1 between predicted scores (N, V) and a query's label vector (V,).

    0 if either is zero.
    """
    lengths = np.linalg.norm(predicted, axis=1) * np.linalg.norm(query)
    return np.asarray(predicted @ query / np.maximum(lengths, 1e-12))
