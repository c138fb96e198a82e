"""Perera's task model (2009, section 5): persons and tasks by weighted distances of joints.

P (positions, people, tasks) = Q x_1 S_position x_2 S_people x_3 S_task (eq. 12), of motions
scaled to one body and one length. A probe is projected onto the span of S_position. There, each of
its joints is compared with the same joint of every training motion (eq. 13). A category is chosen
by the smallest distances of its joints, weighted and summed (eq. 14).

As printed, eq. 14 maximizes a sum of distances. Each joint then votes for the category in which it
is nearest, and far joints have more weight than near ones (Reading.PRINTED). The paper probably
means the smallest sum over all joints (Reading.LEAST).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.cells import cell_means, even_cells, find_cells
from app.models.recognition.multilinear import MAX_CELLS, MAX_TAKES, complete_tensor
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import squared_distances
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.numerics.tensors.nmode_svd import NModeSVD, nmode_svd

JOINTS = len(SUN_ROLES)

LINKS: dict[JointRole, int] = {
    JointRole.HIPS: 1,
    JointRole.NECK: 2,
    JointRole.HEAD: 3,
    **dict.fromkeys((JointRole.LEFT_SHOULDER, JointRole.RIGHT_SHOULDER), 3),
    **dict.fromkeys((JointRole.LEFT_ELBOW, JointRole.RIGHT_ELBOW), 4),
    **dict.fromkeys((JointRole.LEFT_HAND, JointRole.RIGHT_HAND), 5),
    **dict.fromkeys((JointRole.LEFT_KNEE, JointRole.RIGHT_KNEE), 2),
    **dict.fromkeys((JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT), 3),
}
"""Number of links from the center of the body; in the paper, the waist has one."""

MAX_AXES = 200
"""Largest number of columns of S_position; the motions of the paper's library span fewer."""


class Reading(StrEnum):
    """How eq. 14 is interpreted."""

    LEAST = "least"
    """The category with the smallest weighted sum of its joints' distances."""
    PRINTED = "printed"
    """The category with the largest weighted sum over the joints that are nearest to it."""


def link_weights() -> FloatArray:
    """(13,) W of eq. 14 in SUN_ROLES order, by the number of links to the body's center; sum 1."""
    links = np.array([LINKS[role] for role in SUN_ROLES], dtype=np.float64)
    return np.asarray(links / links.sum())


@dataclass(frozen=True, slots=True)
class TaskModel:
    """A fitted task model with c recorded cells (a person at a task).

    persons: (P,) and tasks: (T,) sorted labels; axes: (d, r) uncentered axes that span the
    motions; svd: the factors of the tensor (r, P, T) in these coordinates; person, task: (c,) the
    label indices of the recorded cells; cells: (c, 13, samples x 3) the joints of these cells as
    the factors reconstruct them; weights: (13,) of the joints.
    """

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    axes: PrincipalAxes
    svd: NModeSVD
    person: IntArray
    task: IntArray
    cells: FloatArray
    weights: FloatArray

    def joint_distances(self, poses: FloatArray) -> FloatArray:
        """(n, c, 13) squared distances of each joint of `poses` (n, samples, 13, 3) to the same
        joint of each recorded cell, in the span of S_position (eq. 13)."""
        probes = self._in_subdomain(poses)
        out = np.empty((len(probes), len(self.person), JOINTS))
        for joint in range(JOINTS):
            out[:, :, joint] = squared_distances(probes[:, joint], self.cells[:, joint])
        return out

    def _in_subdomain(self, poses: FloatArray) -> FloatArray:
        """(n, 13, samples x 3) the projection of `poses` onto the span of S_position."""
        position = self.svd.factors[0]
        points = self.axes.project(np.asarray(poses).reshape(len(poses), -1))
        return _by_joint(points @ position @ position.T @ self.axes.axes.T)

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        position, people, tasks = self.svd.factors
        arrays = {
            "centre": self.axes.center,
            "axes": self.axes.axes,
            "core": self.svd.core,
            "position_mode": position,
            "people_mode": people,
            "task_mode": tasks,
        }
        arrays |= {name: getattr(self, name) for name in ("person", "task", "cells", "weights")}
        return arrays, {"persons": list(self.persons), "tasks": list(self.tasks)}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> TaskModel:
        """The model from the result of `to_arrays`."""
        modes = (arrays["position_mode"], arrays["people_mode"], arrays["task_mode"])
        return cls(
            tuple(meta["persons"]),
            tuple(meta["tasks"]),
            PrincipalAxes(arrays["centre"], arrays["axes"]),
            NModeSVD(arrays["core"], modes),
            *(arrays[name] for name in ("person", "task", "cells", "weights")),
        )


def fit_task_model(
    poses: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    ranks: tuple[int | None, int | None, int | None] = (None, None, None),
) -> TaskModel:
    """Fit on motions (n, samples, 13, 3) in the body frame.

    Motions without both labels are left out; the takes of one cell are averaged.

    Cells that nobody recorded are predicted for the factorization (app.models.cells). They are
    never compared with a probe. ranks: columns kept of S_position, S_people and S_task, None for
    all. Raises NotEnoughLabels without a cell, or with more than MAX_CELLS cells.
    """
    use = even_cells(persons, tasks, MAX_TAKES)
    cells = find_cells([persons[i] for i in use], [tasks[i] for i in use])
    if not len(cells):
        raise NotEnoughLabels("The task model needs motions with a person and a task.")
    if len(cells.persons) * len(cells.tasks) > MAX_CELLS:
        raise NotEnoughLabels(f"The task model holds {MAX_CELLS} persons x tasks.")
    flat = np.asarray(poses, dtype=np.float64)[use].reshape(len(use), -1)
    means = cell_means(flat, cells)
    axes = principal_axes(means, MAX_AXES, centered=False)
    tensor = np.moveaxis(complete_tensor(axes.project(means), cells), 2, 0)
    svd = nmode_svd(tensor, ranks)
    recorded = svd.reconstruct()[:, cells.person, cells.task].T @ axes.axes.T
    return TaskModel(
        cells.persons,
        cells.tasks,
        axes,
        svd,
        cells.person,
        cells.task,
        _by_joint(recorded),
        link_weights(),
    )


def objective(
    distances: FloatArray, label: IntArray, labels: int, weights: FloatArray, reading: Reading
) -> FloatArray:
    """(n, labels) the objective of each category by eq. 14; the smallest is the best.

    With Reading.PRINTED it is negative, because eq. 14 is maximized.

    distances: (n, c, 13) of `TaskModel.joint_distances`; label: (c,) the category of each cell,
    each of `labels` at least once; weights: (13,).
    """
    order = np.argsort(label, kind="stable")
    starts = np.searchsorted(label[order], np.arange(labels))
    # (n, labels, 13) for each category the smallest distance of each joint
    smallest = np.minimum.reduceat(distances[:, order], starts, axis=1)
    if reading is Reading.LEAST:
        return np.asarray(smallest @ weights)
    is_nearest = smallest == smallest.min(axis=1, keepdims=True)
    return np.asarray(-np.where(is_nearest, smallest, 0.0) @ weights)


def _by_joint(flat: FloatArray) -> FloatArray:
    """(n, 13, samples x 3) of (n, samples x 13 x 3)."""
    whole = flat.reshape(len(flat), -1, JOINTS, 3)
    return np.ascontiguousarray(whole.transpose(0, 2, 1, 3)).reshape(len(flat), JOINTS, -1)
