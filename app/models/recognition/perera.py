"""Perera's recognition on a library (2009, section 5.3): method "perera".

The motion sample of a clip is compared with the task model of all labeled clips. The best category
has the smallest objective (eq. 14). Eqs 15-16 decide whether the clip belongs to it: they compare
the objective with F*_k, the objective of clips of that category from other recordings. The paper
sets the thresholds by hand; here they are fitted on held-out clips, tasks and persons, or follow
from a false-accept rate.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.models.cells import even_cells
from app.models.holding_out import HeldOut, rounds
from app.models.recognition.answers import Answer, Recognition, answer, given
from app.models.recognition.calibration import NEW, Calibration, fit_calibration
from app.models.recognition.multilinear import MAX_TAKES
from app.models.recognition.task_model import JOINTS, Reading, TaskModel, fit_task_model, objective
from app.numerics.arrays import BoolArray, FloatArray, IntArray

TENSOR_RECOGNIZER_VERSION = 1

SHARPNESS = 20.0
"""Factor from logarithms of the objective to evidence and novelty; calibration rescales both."""

_MIN_OBJECTIVE = 1e-12
"""Smallest objective, in squared body lengths: a clip of the library itself has distance 0."""

Labels = Sequence[str | None]


@dataclass(frozen=True, slots=True)
class TensorRecognizer:
    """A fitted recognizer.

    reach_of_persons: (P,) and reach_of_tasks: (T,) F*_k of each person and task.
    """

    model: TaskModel
    reach_of_persons: FloatArray
    reach_of_tasks: FloatArray
    person_calibration: Calibration
    task_calibration: Calibration

    def accepting(self, false_accept_rate: float) -> TensorRecognizer:
        """The same recognizer with another threshold.

        At most the share `false_accept_rate` (0..1) of new held-out clips is then called known.
        """
        return replace(
            self,
            person_calibration=self.person_calibration.at_false_acceptance(false_accept_rate),
            task_calibration=self.task_calibration.at_false_acceptance(false_accept_rate),
        )

    def to_arrays(self) -> tuple[dict[str, np.ndarray[Any, Any]], dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays, meta = self.model.to_arrays()
        person, meta["person_calibration"] = self.person_calibration.to_arrays("person")
        task, meta["task_calibration"] = self.task_calibration.to_arrays("task")
        reach = {"persons_reach": self.reach_of_persons, "tasks_reach": self.reach_of_tasks}
        return arrays | person | task | reach, meta | {"version": TENSOR_RECOGNIZER_VERSION}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> TensorRecognizer:
        """The recognizer from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != TENSOR_RECOGNIZER_VERSION:
            raise ValueError(f"tensor recognizer of version {meta['version']}")
        return cls(
            TaskModel.from_arrays(arrays, meta),
            arrays["persons_reach"],
            arrays["tasks_reach"],
            Calibration.from_arrays("person", arrays, meta["person_calibration"]),
            Calibration.from_arrays("task", arrays, meta["task_calibration"]),
        )


def fit_tensor_recognizer(
    samples: FloatArray, persons: Labels, tasks: Labels, groups: Sequence[str] | None = None
) -> TensorRecognizer:
    """Fit on motion samples (clips, 1250); clips without both labels are left out.

    groups: (clips,) clips of one recording share a value and are held out together. Of a library of
    more than MAX_TAKES clips, evenly chosen takes of each cell are used.
    Raises NotEnoughLabels without a cell, or with more than MAX_CELLS cells.
    """
    use = even_cells(persons, tasks, MAX_TAKES)
    poses = poses_of(np.asarray(samples)[use])
    who, what = [persons[i] for i in use], [tasks[i] for i in use]
    together = [groups[i] if groups is not None else str(i) for i in use]
    model = fit_task_model(poses, who, what)
    results = [
        _Round.of(poses, who, what, kind, train, probe, model)
        for kind, train, probe in rounds(who, what, together)
    ]
    person_results = [
        (one.of_persons, one.person, one.seen) for one in results if one.kind is not HeldOut.TASKS
    ]
    task_results = [(one.of_tasks, one.task, one.seen) for one in results]
    reaches = _reach(person_results, len(model.persons)), _reach(task_results, len(model.tasks))
    calibrations = [
        _calibrated(each, reach)
        for each, reach in zip((person_results, task_results), reaches, strict=True)
    ]
    return TensorRecognizer(model, *reaches, *calibrations)


def uncalibrated(samples: FloatArray, persons: Labels, tasks: Labels) -> TensorRecognizer:
    """As `fit_tensor_recognizer`, but without calibration on held-out clips.

    Its candidates are in the right order; its scores and its decision on what is unknown have no
    meaning. Raises NotEnoughLabels.
    """
    model = fit_task_model(poses_of(samples), persons, tasks)
    person_reach, task_reach = np.ones(len(model.persons)), np.ones(len(model.tasks))
    return TensorRecognizer(
        model,
        person_reach,
        task_reach,
        _calibrated([], person_reach),
        _calibrated([], task_reach),
    )


def recognize_by_tensor(
    record: TensorRecognizer,
    samples: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> list[Recognition]:
    """Recognize who does what in motion samples (n, 1250).

    If the other factor is known, a probe is compared only with the cells of that label; a known
    label that the library does not have is ignored.
    """
    model = record.model
    distances = model.joint_distances(poses_of(samples))
    person_objectives = _objectives(
        model, distances, "person", _only(model.tasks, model.task, known_task)
    )
    task_objectives = _objectives(
        model, distances, "task", _only(model.persons, model.person, known_person)
    )
    who = _answers(
        person_objectives, model.persons, record.reach_of_persons, record.person_calibration
    )
    what = _answers(task_objectives, model.tasks, record.reach_of_tasks, record.task_calibration)
    if known_person is not None:
        who = [given(known_person, model.persons)] * len(who)
    if known_task is not None:
        what = [given(known_task, model.tasks)] * len(what)
    return [Recognition(one, other) for one, other in zip(who, what, strict=True)]


def poses_of(samples: FloatArray) -> FloatArray:
    """(n, 32, 13, 3) the poses of motion samples (n, 1250), without their turn and speed."""
    positions = np.asarray(samples, dtype=np.float64)[:, :-2]
    moments = positions.shape[1] // (3 * JOINTS)
    return positions.reshape(len(positions), moments, JOINTS, 3)


@dataclass(frozen=True, slots=True)
class _Round:
    """The results of a model of the training clips on n probes.

    of_persons (n, P), of_tasks (n, T): objectives, inf for labels without training clips;
    person, task: (n,) the true label index, NEW without training clips; seen: (n,) whether the
    training clips have both labels together.
    """

    kind: HeldOut
    of_persons: FloatArray
    of_tasks: FloatArray
    person: IntArray
    task: IntArray
    seen: BoolArray

    @classmethod
    def of(
        cls,
        poses: FloatArray,
        persons: Labels,
        tasks: Labels,
        kind: HeldOut,
        train: IntArray,
        probe: IntArray,
        whole: TaskModel,
    ) -> _Round:
        model = fit_task_model(poses[train], [persons[i] for i in train], [tasks[i] for i in train])
        distances = model.joint_distances(poses[probe])
        pairs = {(persons[i], tasks[i]) for i in train}
        return cls(
            kind,
            _spread(_objectives(model, distances, "person", None), model.persons, whole.persons),
            _spread(_objectives(model, distances, "task", None), model.tasks, whole.tasks),
            _index([persons[i] for i in probe], model.persons, whole.persons),
            _index([tasks[i] for i in probe], model.tasks, whole.tasks),
            np.array([(persons[i], tasks[i]) in pairs for i in probe], dtype=bool),
        )


def _objectives(
    model: TaskModel, distances: FloatArray, factor: str, cells: BoolArray | None
) -> FloatArray:
    """(n, labels) the minimized eq. 14 over the chosen cells (c,); inf for labels without one."""
    label, names = (
        (model.person, model.persons) if factor == "person" else (model.task, model.tasks)
    )
    if cells is not None:
        distances = np.where(cells[:, None], distances, np.inf)
    return objective(distances, label, len(names), model.weights, Reading.LEAST)


def _only(names: tuple[str, ...], label: IntArray, known: str | None) -> BoolArray | None:
    """(c,) whether each cell has the known label; None if the model does not have it."""
    return np.asarray(label == names.index(known)) if known in names else None


def _spread(objectives: FloatArray, names: tuple[str, ...], whole: tuple[str, ...]) -> FloatArray:
    """(n, whole) the objectives (n, names) in the columns of their names; inf in the others."""
    out = np.full((len(objectives), len(whole)), np.inf)
    out[:, [whole.index(name) for name in names]] = objectives
    return out


def _index(labels: Labels, seen: tuple[str, ...], whole: tuple[str, ...]) -> IntArray:
    """(n,) the index of each label in `whole`, NEW for a label that is not in `seen`."""
    index = [whole.index(str(label)) if label in seen else NEW for label in labels]
    return np.array(index, dtype=np.int64)


_HeldOutResults = tuple[FloatArray, IntArray, BoolArray]
"""objectives (n, labels), truth (n,) and seen (n,), as `_Round` has them."""


def _concatenated(held: list[_HeldOutResults], labels: int) -> _HeldOutResults:
    empty = (np.zeros((0, labels)), np.zeros(0, dtype=np.int64), np.zeros(0, dtype=bool))
    objectives, truth, seen = (np.concatenate(part) for part in zip(empty, *held, strict=True))
    return objectives, truth, seen


def _reach(held: list[_HeldOutResults], labels: int) -> FloatArray:
    """(labels,) F*_k: the mean objective of the held-out clips of each label.

    If there are held-out clips whose cells were in the training, only these are used, else all
    held-out clips. A label without such clips gets the mean of all.
    """
    objectives, truth, seen = _concatenated(held, labels)
    usual = (truth != NEW) & seen
    chosen = usual if usual.any() else truth != NEW
    values, own = objectives[chosen, truth[chosen]], truth[chosen]
    counts = np.bincount(own, minlength=labels)
    otherwise = float(values.mean()) if len(values) else 1.0
    sums = np.bincount(own, values, minlength=labels)
    means = np.where(counts > 0, sums / np.maximum(counts, 1), otherwise)
    return np.asarray(np.maximum(means, _MIN_OBJECTIVE))


def _calibrated(held: list[_HeldOutResults], reach: FloatArray) -> Calibration:
    objectives, truth, seen = _concatenated(held, len(reach))
    return fit_calibration(_evidence(objectives), _novelty(objectives, reach), truth, seen)


def _evidence(objectives: FloatArray) -> FloatArray:
    return np.asarray(-SHARPNESS * np.log(np.maximum(objectives, _MIN_OBJECTIVE)))


def _novelty(objectives: FloatArray, reach: FloatArray) -> FloatArray:
    """(n,) logarithm of the smallest ratio of an objective to its F*_k (eqs 15-16)."""
    shares = np.maximum(objectives / reach, _MIN_OBJECTIVE)
    return np.asarray(SHARPNESS * np.log(shares.min(axis=1, initial=np.inf)))


def _answers(
    objectives: FloatArray, names: tuple[str, ...], reach: FloatArray, calibration: Calibration
) -> list[Answer]:
    new = _novelty(objectives, reach)
    beliefs = calibration.beliefs(_evidence(objectives), new)
    beyond = (new - calibration.threshold) / calibration.scale
    return [
        answer(names, row, bool(n <= 0), float(n)) for row, n in zip(beliefs, beyond, strict=True)
    ]
