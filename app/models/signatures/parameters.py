"""Signatures of persons and parameters of actions (Vasilescu 2002, section 3), to be compared.

The rows of P are signatures, and the rows of A are the parameters of actions. Both matrices have
orthonormal columns, so with all columns kept, any two rows are equally far apart. What makes two
persons move alike is how much a parameter changes motions, which is its singular value. So points
and distances are those of rows times singular values.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.models.recognition.multilinear import Multilinear
from app.numerics.arrays import FloatArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.numerics.tensors.tensor import unfold

POINT_DIMENSIONS = 2
"""The number of principal axes of a plot."""


@dataclass(frozen=True, slots=True)
class Parameters:
    """The parameters of n persons, or of n tasks.

    names: (n,) labels. vectors: (n, R) rows of the mode matrix. singular_values: (R,) of the mode,
    in the unit of the samples. axes: the principal axes of vectors times singular values. kept: the
    share of their variance that a plot of two axes shows.
    """

    names: tuple[str, ...]
    vectors: FloatArray
    singular_values: FloatArray
    axes: PrincipalAxes
    kept: float

    def points(self, vectors: FloatArray) -> FloatArray:
        """(m, 2) places in the plot of parameters (m, R): of these, or of clips."""
        places = self.axes.project(vectors * self.singular_values)
        return np.pad(places, ((0, 0), (0, POINT_DIMENSIONS - places.shape[1])))


def person_parameters(model: Multilinear) -> Parameters:
    """The signatures of the model's persons."""
    return _parameters(model, 0, model.persons)


def task_parameters(model: Multilinear) -> Parameters:
    """The action parameters of the model's tasks."""
    return _parameters(model, 1, model.tasks)


def _parameters(model: Multilinear, mode: int, names: tuple[str, ...]) -> Parameters:
    vectors = model.svd.factors[mode]
    # the rows of the core's unfolding are orthogonal, and their lengths are the singular values
    singular_values = np.linalg.norm(unfold(model.svd.core, mode), axis=1)
    weighted = vectors * singular_values
    axes = principal_axes(weighted, POINT_DIMENSIONS)
    whole = float(np.square(weighted - axes.center).sum())
    shown = float(np.square(axes.project(weighted)).sum())
    kept = min(shown / whole, 1.0) if whole > 0 else 1.0
    return Parameters(names, vectors, singular_values, axes, kept)
