"""The default word model: kernel ridge from clip statistics to label vectors.

The words of a clip are ranked by the model's output. The conversion of outputs to probabilities, of
one word and of several, is separate (app.models.words.calibration). Shapes: clips N, words V,
statistics p (131 of app.analysis.symbols.channels).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.numerics.arrays import FloatArray
from app.numerics.kernel_ridge import KernelRidge, fit_kernel_ridge, refit_kernel_ridge

WORD_MODEL_VERSION = 1

MAX_DEVIATIONS = 10.0
"""Limit of standardized statistics, so that one broken clip cannot distort the kernel."""


@dataclass(frozen=True, slots=True)
class WordModel:
    """mean, scale: (p,) standardize the statistics; ridge: maps them to V outputs."""

    mean: FloatArray
    scale: FloatArray
    ridge: KernelRidge

    def outputs(self, statistics: FloatArray) -> FloatArray:
        """(N, V) outputs for clips with `statistics` (N, p): about 0..1, but not limited to it."""
        return self.ridge.predict(standardize(statistics, self.mean, self.scale))

    def predict(self, statistics: FloatArray) -> FloatArray:
        """(N, V) the outputs, limited to 0..1."""
        return np.clip(self.outputs(statistics), 0.0, 1.0)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = {
            "mean": self.mean,
            "scale": self.scale,
            "centres": self.ridge.centers,
            "weights": self.ridge.weights,
            "offset": self.ridge.offset,
        }
        meta = {
            "version": WORD_MODEL_VERSION,
            "width": self.ridge.width,
            "penalty": self.ridge.penalty,
        }
        return arrays, meta

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> WordModel:
        """The model from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != WORD_MODEL_VERSION:
            raise ValueError(f"word model of version {meta['version']}")
        ridge = KernelRidge(
            arrays["centres"], arrays["weights"], arrays["offset"], meta["width"], meta["penalty"]
        )
        return cls(arrays["mean"], arrays["scale"], ridge)


def fit_word_model(statistics: FloatArray, labels: FloatArray, *, seed: int = 0) -> WordModel:
    """Fit on `statistics` (n, p) and label vectors (n, V) of the labeled clips.

    Raises NotEnoughLabels without a clip or without a word.
    """
    if labels.shape[0] == 0 or labels.shape[1] == 0:
        raise NotEnoughLabels("No clip has words.")
    rows = np.asarray(statistics, dtype=np.float64)
    mean, scale = rows.mean(axis=0), rows.std(axis=0)
    scale = np.where(scale > 1e-6, scale, 1.0)  # a channel that never varies carries no information
    ridge = fit_kernel_ridge(standardize(rows, mean, scale), labels, seed=seed)
    return WordModel(mean, scale, ridge)


def refit_word_model(
    like: WordModel, statistics: FloatArray, labels: FloatArray, *, seed: int = 0
) -> WordModel:
    """Fit on some (n >= 1) of the clips of another model, with its kernel and scales."""
    rows = standardize(statistics, like.mean, like.scale)
    ridge = refit_kernel_ridge(like.ridge, rows, labels, seed=seed)
    return WordModel(like.mean, like.scale, ridge)


def standardize(statistics: FloatArray, mean: FloatArray, scale: FloatArray) -> FloatArray:
    """(N, p) (`statistics` - `mean`) / `scale`, limited to +-MAX_DEVIATIONS."""
    deviations = (np.asarray(statistics, dtype=np.float64) - mean) / scale
    return np.clip(deviations, -MAX_DEVIATIONS, MAX_DEVIATIONS)


def clip_cosines(predicted: FloatArray, query: FloatArray) -> FloatArray:
    """(N,) cosine in 0..1 between predicted scores (N, V) and a query's label vector (V,).

    0 if either is zero.
    """
    lengths = np.linalg.norm(predicted, axis=1) * np.linalg.norm(query)
    return np.asarray(predicted @ query / np.maximum(lengths, 1e-12))
