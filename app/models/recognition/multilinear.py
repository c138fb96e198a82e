"""The multilinear model of Vasilescu 2002: signatures of persons, parameters of actions.

D (persons P, tasks T, samples) = Z x_1 P x_2 A x_3 J (eq. 3). D holds the mean motion of each
cell. A cell is a person at a task. A cell without clips gets the sum of the effects of its person
and its task (app.models.cells). Samples are represented by at most 100 PCA coordinates. They are
not centered, because the tensor of the paper is not. If the caller knows the person or the task of
a clip, the other label is recognized as in section 5. Else both labels are those of the nearest
reconstructed cell.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.cells import Cells, cell_means, even_cells, find_cells, fit_effects
from app.models.recognition.answers import Recognition, answer, given
from app.models.recognition.calibration import softmax
from app.models.recognition.task_means import TaskMeans, fit_task_means
from app.numerics.arrays import FloatArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.numerics.tensors.nmode_svd import NModeSVD, nmode_svd
from app.numerics.tensors.tensor import mode_product

MULTILINEAR_VERSION = 2

DIMENSIONS = 100
"""The largest number of coordinates of the sample mode."""

MAX_TAKES = 2000
"""The largest number of clips of the fit, of more cells one of each. The model holds the means of
cells: of a larger library, each cell with many takes gives some of them."""

MIN_SINGULAR = 0.005
"""Relative cut-off of the pseudo-inverses of B_a and C_p. Slices filled by completion have nearly
low rank; without a cut-off the inverse would amplify noise."""

MAX_CELLS = 20_000
"""The largest number of persons x tasks: a larger tensor would not fit a small machine."""

RADIUS_SHARE = 95.0
"""Percentile of the training clips' distances to their cells that gives the radius."""

RADIUS_SLACK = 1.5
"""Factor on the radius: held-out takes are farther from their cells than the takes of the fit."""


@dataclass(frozen=True)
class Multilinear:
    """A fitted multilinear model.

    persons: (P,) and tasks: (T,) sorted labels. axes: the PCA coordinates. svd: the core tensor
    and the mode matrices: persons (P, R1), whose rows are the signatures, actions (T, R2), and
    eigenmotions (d, R3) in the coordinates of `axes`. radius: a clip that is farther than this
    from all cells, in these coordinates, is unknown. task_means: the means onto which the motions
    of each task were warped before the fit; None if they were not.
    """

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    axes: PrincipalAxes
    svd: NModeSVD
    radius: float
    task_means: TaskMeans | None = None

    @cached_property
    def cells(self) -> FloatArray:
        """(P, T, d) the coordinates of each person at each task. Every recognition reads them."""
        return self.svd.reconstruct()

    def aligned(self, sample: FloatArray, task: str) -> FloatArray:
        """A sample (1250,) warped onto the mean of `task`, as the motions of the tensor are."""
        if self.task_means is None:
            return sample
        moments, width = self.task_means.means.shape[1:]
        poses = np.asarray(sample[: moments * width]).reshape(1, moments, width)
        warped = self.task_means.onto(poses, task)
        return np.concatenate([warped.ravel(), sample[moments * width :]])

    def signature(self, sample: FloatArray, task: str) -> FloatArray:
        """(R1,) p = B_a^-T d of a motion sample (1250,) of `task` (section 5)."""
        core, (_, actions, motions) = self.svd.core, self.svd.factors
        row = actions[[self.tasks.index(task)]]
        basis = mode_product(mode_product(core, row, 1), motions, 2)[:, 0, :]
        return _coordinates(basis, self.axes.project(sample))

    def action(self, sample: FloatArray, person: str) -> FloatArray:
        """(R2,) a = C_p^-T d of a motion sample (1250,) by `person` (section 5)."""
        core, (people, _, motions) = self.svd.core, self.svd.factors
        row = people[[self.persons.index(person)]]
        basis = mode_product(mode_product(core, row, 0), motions, 2)[0]
        return _coordinates(basis, self.axes.project(sample))

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        people, actions, motions = self.svd.factors
        arrays = {
            "centre": self.axes.center,
            "axes": self.axes.axes,
            "core": self.svd.core,
            "people": people,
            "actions": actions,
            "motions": motions,
        }
        meta = {
            "version": MULTILINEAR_VERSION,
            "persons": list(self.persons),
            "tasks": list(self.tasks),
            "radius": self.radius,
        }
        if self.task_means is not None:
            arrays["courses"] = self.task_means.means
        return arrays, meta

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> Multilinear:
        """The model from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != MULTILINEAR_VERSION:
            raise ValueError(f"multilinear model of version {meta['version']}")
        factors = (arrays["people"], arrays["actions"], arrays["motions"])
        return cls(
            tuple(meta["persons"]),
            tuple(meta["tasks"]),
            PrincipalAxes(arrays["centre"], arrays["axes"]),
            NModeSVD(arrays["core"], factors),
            float(meta["radius"]),
            TaskMeans(tuple(meta["tasks"]), arrays["courses"]) if "courses" in arrays else None,
        )


def fit_multilinear(
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    ranks: tuple[int | None, int | None] = (None, None),
    moments: int | None = None,
) -> Multilinear:
    """Fit a model on motion samples.

    samples: (clips, 1250); persons, tasks: (clips,) labels. A clip without both labels is left
    out. ranks: the numbers of columns to keep of the person and the action matrices; None keeps
    all. moments: the number of poses at the start of each sample, which are warped onto the mean
    of the clip's task; None leaves them as they are.
    Raises NotEnoughLabels without two persons or two tasks, or with more than MAX_CELLS cells.
    """
    use = even_cells(persons, tasks, MAX_TAKES)
    cells = find_cells([persons[i] for i in use], [tasks[i] for i in use])
    if min(len(cells.persons), len(cells.tasks)) < 2:
        raise NotEnoughLabels("The multilinear model needs two persons and two tasks.")
    if len(cells.persons) * len(cells.tasks) > MAX_CELLS:
        raise NotEnoughLabels(f"The multilinear model holds {MAX_CELLS} persons x tasks.")
    chosen, task_means = np.asarray(samples)[use], None
    if moments is not None:
        chosen, task_means = _aligned(chosen, [tasks[i] for i in use], moments)
    axes = principal_axes(chosen, DIMENSIONS, centered=False)
    points = axes.project(chosen)
    tensor = complete_tensor(cell_means(points, cells), cells)
    svd = nmode_svd(tensor, [*ranks, None])
    own = svd.reconstruct()[cells.person[cells.member], cells.task[cells.member]]
    distance = np.percentile(np.linalg.norm(points - own, axis=1), RADIUS_SHARE)
    radius = float(distance * RADIUS_SLACK)
    return Multilinear(cells.persons, cells.tasks, axes, svd, radius, task_means)


def _aligned(
    samples: FloatArray, tasks: Sequence[str | None], moments: int
) -> tuple[FloatArray, TaskMeans]:
    """`samples` (n, w) with warped poses, and the means of the tasks onto which they are warped.

    The first numbers of a sample are the poses of `moments` moments. The others stay as they are.
    """
    width = samples.shape[1] // moments
    poses = samples[:, : moments * width].reshape(len(samples), moments, width)
    task_means = fit_task_means(poses, tasks)
    warped = task_means.aligned(poses, tasks).reshape(len(samples), -1)
    return np.hstack([warped, samples[:, moments * width :]]), task_means


def complete_tensor(means: FloatArray, cells: Cells) -> FloatArray:
    """(P, T, d) the tensor of the cell `means` (cells, d).

    Missing cells are predicted from person and task effects.
    """
    persons, tasks = len(cells.persons), len(cells.tasks)
    person, task = np.divmod(np.arange(persons * tasks), tasks)
    predicted = fit_effects(means, cells).predict(person, task)
    tensor = predicted.reshape(persons, tasks, means.shape[1])
    tensor[cells.person, cells.task] = means
    return tensor


def recognize_multilinear(
    record: Multilinear,
    sample: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> Recognition:
    """Recognize who does what in one motion sample (1250,).

    known_person, known_task: the label that the caller knows. It is part of the answer. A label
    that the library does not have is not used to recognize the other one. Scores are shares by
    nearness, not probabilities. A clip that is farther than the radius from every cell is unknown.
    """
    distances = np.linalg.norm(record.cells - record.axes.project(sample), axis=2)
    person = given(known_person, record.persons) if known_person else None
    task = given(known_task, record.tasks) if known_task else None
    to_persons, to_tasks = distances.min(axis=1), distances.min(axis=0)
    if known_task in record.tasks:
        people = record.svd.factors[0]
        own = record.signature(record.aligned(sample, known_task), known_task)
        to_persons = np.linalg.norm(own - people, axis=1)
    elif record.task_means is not None:
        # the person is recognized without the timing, the task with it
        likely = int(to_tasks.argmin())
        point = record.axes.project(record.aligned(sample, record.tasks[likely]))
        to_persons = np.linalg.norm(record.cells[:, likely] - point, axis=1)
    if known_person in record.persons:
        actions = record.svd.factors[1]
        to_tasks = np.linalg.norm(record.action(sample, known_person) - actions, axis=1)
    is_known = bool(distances.min() <= record.radius)
    return Recognition(
        person or answer(record.persons, shares(to_persons), is_known),
        task or answer(record.tasks, shares(to_tasks), is_known),
    )


def _coordinates(basis: FloatArray, point: FloatArray) -> FloatArray:
    """The row c with c @ basis nearest to `point`: (R, d) and (d,) -> (R,)."""
    return np.asarray(point @ np.linalg.pinv(basis, rcond=MIN_SINGULAR))


def shares(distances: FloatArray) -> FloatArray:
    """(n,) shares that sum to 1 and fall with `distances` (n,); the smallest one is the unit."""
    scale = max(float(distances.min()), 1e-9)
    return np.asarray(softmax(-0.5 * ((distances / scale) ** 2)[None])[0])
