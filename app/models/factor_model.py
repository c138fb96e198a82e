"""The multilinear model with any number of factors: person, task, and style, take, source ...

D (factor 1, ..., factor N, samples) = Z x_1 U_1 ... x_N U_N x_N+1 J, as Vasilescu 2002 says of
her eq. 3 ("any number of factors"). Its cells are all combinations, most of which nobody ever
recorded; those are completed by the effects of their labels added up, as with two factors
(app.models.cells).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.cells import EFFECT_RIDGE
from app.models.multilinear import DIMENSIONS, MOST_CELLS, SMALLEST_SINGULAR, shares
from app.models.recognition import Answer, answer, given
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.nmode_svd import NModeSVD, nmode_svd
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.numerics.tensor import mode_product

Known = Mapping[str, str]
"""Label by factor."""


@dataclass(frozen=True, slots=True)
class FactorModel:
    """names: (N,) the factors; labels: of each factor sorted; svd: the core, the N mode matrices
    and the eigenmotions (d, R) in the coordinates of `axes`; recorded: (c, N) the combinations
    that were recorded, as indices."""

    names: tuple[str, ...]
    labels: tuple[tuple[str, ...], ...]
    axes: PrincipalAxes
    svd: NModeSVD
    recorded: IntArray

    def motion(self, labels: Known) -> FloatArray:
        """(w,) the model's motion sample of one label of every factor, recorded or not."""
        tensor = self.svd.core
        for mode, name in enumerate(self.names):
            tensor = mode_product(tensor, self._row(mode, labels[name]), mode)
        point = mode_product(tensor, self.svd.factors[-1], len(self.names)).reshape(-1)
        return np.asarray(self.axes.centre + self.axes.axes @ point)

    def eigenmotions(self) -> FloatArray:
        """(w, R) the orthonormal motions of which all are made, in the samples' own numbers."""
        return np.asarray(self.axes.axes @ self.svd.factors[-1])

    def parameters(self, sample: FloatArray, factor: str, others: Known) -> FloatArray:
        """(R,) a sample's (w,) coordinates along the mode of `factor`, given the label of every
        other factor (section 5): for persons, the signature."""
        own, tensor = self.names.index(factor), self.svd.core
        for mode, name in enumerate(self.names):
            if mode != own:
                tensor = mode_product(tensor, self._row(mode, others[name]), mode)
        tensor = mode_product(tensor, self.svd.factors[-1], len(self.names))
        basis = np.moveaxis(tensor, own, 0).reshape(tensor.shape[own], -1)
        point = self.axes.project(sample)
        return np.asarray(point @ np.linalg.pinv(basis, rcond=SMALLEST_SINGULAR))

    def recognise(self, sample: FloatArray, known: Known | None = None) -> dict[str, Answer]:
        """The answer for each factor of one motion sample (w,), given what is known.

        A factor of which all others are known is told by its parameters; else by the nearest
        combination, recorded or completed, that agrees with what is known. Scores are shares by
        nearness. Labels that the model lacks tell nothing.
        """
        told = {
            name: label
            for name, label in (known or {}).items()
            if label in self.labels[self.names.index(name)]
        }
        far = np.linalg.norm(self.svd.reconstruct() - self.axes.project(sample), axis=-1)
        for name, label in told.items():
            mode = self.names.index(name)
            wrong = np.arange(far.shape[mode]) != self.labels[mode].index(label)
            far[(slice(None),) * mode + (wrong,)] = np.inf
        return {name: self._answer(sample, mode, far, told) for mode, name in enumerate(self.names)}

    def _answer(self, sample: FloatArray, mode: int, far: FloatArray, told: Known) -> Answer:
        name, labels = self.names[mode], self.labels[mode]
        if name in told:
            return given(told[name], labels)
        if len(told) == len(self.names) - 1:
            apart = self.svd.factors[mode] - self.parameters(sample, name, told)
            return answer(labels, shares(np.linalg.norm(apart, axis=1)), known=True)
        others = tuple(other for other in range(far.ndim) if other != mode)
        return answer(labels, shares(far.min(axis=others)), known=True)

    def _row(self, mode: int, label: str) -> FloatArray:
        return self.svd.factors[mode][[self.labels[mode].index(label)]]


def fit_factor_model(
    samples: FloatArray,
    factors: Mapping[str, Sequence[str | None]],
    ranks: Mapping[str, int] | None = None,
) -> FactorModel:
    """Fit on motion or angle samples (clips, w); clips that lack a label are left out.

    factors: by name the clips' labels, (clips,) each; ranks: columns to keep of some of the mode
    matrices. Raises NotEnoughLabels with fewer than two factors of at least two labels, or with
    too many combinations.
    """
    rows = list(zip(*factors.values(), strict=True))
    use = [i for i, row in enumerate(rows) if all(row)]
    labels = tuple(tuple(sorted({str(rows[i][k]) for i in use})) for k in range(len(factors)))
    if sum(len(each) > 1 for each in labels) < 2:
        raise NotEnoughLabels("A multilinear model needs two factors with two labels each.")
    shape = [len(each) for each in labels]
    if np.prod(shape, dtype=np.float64) > MOST_CELLS:
        raise NotEnoughLabels(f"The multilinear model holds {MOST_CELLS} combinations.")
    index = np.array([[labels[k].index(str(rows[i][k])) for k in range(len(shape))] for i in use])
    chosen = np.asarray(samples, dtype=np.float64)[use]
    axes = principal_axes(chosen, DIMENSIONS, centred=False)
    recorded, member = np.unique(index, axis=0, return_inverse=True)
    means = _means(axes.project(chosen), member.reshape(-1), len(recorded))
    tensor = _completed(means, recorded, shape)
    wanted = [(ranks or {}).get(name) for name in factors]
    return FactorModel(tuple(factors), labels, axes, nmode_svd(tensor, [*wanted, None]), recorded)


def _means(points: FloatArray, member: IntArray, cells: int) -> FloatArray:
    sums = np.zeros((cells, points.shape[1]))
    np.add.at(sums, member, points)
    return np.asarray(sums / np.bincount(member, minlength=cells)[:, None])


def _completed(means: FloatArray, recorded: IntArray, shape: Sequence[int]) -> FloatArray:
    """(*shape, d) of means (c, d) at the combinations `recorded` (c, N); the others by the
    effects of their labels, ridge regression's, added up."""
    every = np.indices(shape).reshape(len(shape), -1).T
    design = _one_hot(recorded, shape)
    penalty = np.full(design.shape[1], EFFECT_RIDGE)
    penalty[0] = 1e-9  # the mean of all is drawn nowhere
    effects = np.linalg.solve(design.T @ design + np.diag(penalty), design.T @ means)
    tensor = (_one_hot(every, shape) @ effects).reshape(*shape, means.shape[1])
    tensor[tuple(recorded.T)] = means
    return np.asarray(tensor)


def _one_hot(index: IntArray, shape: Sequence[int]) -> FloatArray:
    """(n, 1 + labels of all factors) of label indices (n, N): a constant, then each label."""
    parts = [np.eye(size)[index[:, mode]] for mode, size in enumerate(shape)]
    return np.hstack([np.ones((len(index), 1)), *parts])
