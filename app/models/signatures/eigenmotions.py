"""Eigenmotions: the columns of J (Vasilescu 2002, eq. 3), as samples that can be shown and played.

The tensor of the paper is not centered. So the first eigenmotion is close to the mean motion, and
the others are the ways in which motions differ from it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.recognition.multilinear import Multilinear
from app.numerics.arrays import FloatArray
from app.numerics.tensors.tensor import multiply_modes


@dataclass(frozen=True, slots=True)
class Eigenmotions:
    """The R eigenmotions of a model, in the coordinates of samples (w numbers).

    vectors: (R, w) orthonormal rows. means, deviations: (R,) mean and standard deviation of the
    weights over all persons and tasks.
    """

    vectors: FloatArray
    means: FloatArray
    deviations: FloatArray

    def __len__(self) -> int:
        return len(self.vectors)

    @property
    def shares(self) -> FloatArray:
        """(R,) the share of each in the variance between persons and tasks; they sum to 1."""
        variances = np.square(self.deviations)
        return np.asarray(variances / max(float(variances.sum()), 1e-12))

    @property
    def mean(self) -> FloatArray:
        """(w,) the mean sample over all persons and tasks."""
        return np.asarray(self.means @ self.vectors)

    def weights(self, samples: FloatArray) -> FloatArray:
        """(n, R) the weights whose sum of eigenmotions is nearest to each sample (n, w)."""
        return np.asarray(np.asarray(samples, dtype=np.float64) @ self.vectors.T)

    def along(self, number: int, deviations: float) -> FloatArray:
        """(w,) the mean and `deviations` standard deviations along an eigenmotion, from 0."""
        step = deviations * self.deviations[number] * self.vectors[number]
        return np.asarray(self.mean + step)


def eigenmotions(model: Multilinear) -> Eigenmotions:
    """The eigenmotions of a model."""
    core, (people, actions, motions) = model.svd.core, model.svd.factors
    weights = multiply_modes(core, [people, actions, None]).reshape(-1, core.shape[2])
    return Eigenmotions(motions.T @ model.axes.axes.T, weights.mean(axis=0), weights.std(axis=0))
