"""The default recogniser: which person does which task, or that it is someone or something new.

Motion samples (1250 numbers, app.analysis.motion_sample) are brought to PCA coordinates and
held against all hypotheses (app.models.hypotheses). Evidence of a label is the sum over the
hypotheses that name it; novelty weighs those that say "new" against those that do not
(DESIGN 6, Unknown; it parted new from known better than the distance to the nearest cell
over that cell's radius). Both are calibrated on clips, persons and tasks held out at fit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.calibration import NEW, Calibration, fit_calibration
from app.models.cells import Cells, find_cells
from app.models.holding_out import Held, rounds
from app.models.hypotheses import Hypotheses, fit_hypotheses
from app.models.recognition import Answer, Recognition, answer, given
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes

RECOGNISER_VERSION = 2

DIMENSIONS = 50
"""PCA coordinates; 30 to 100 recognise alike, fewer tell the unknown better."""

_Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, slots=True)
class Recogniser:
    """persons, tasks: sorted labels, to which indices elsewhere refer."""

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    axes: PrincipalAxes
    hypotheses: Hypotheses
    person_calibration: Calibration
    task_calibration: Calibration

    def accepting(self, false_accept_rate: float) -> Recogniser:
        """The same, calling something new known at this rate at most (of held-out clips)."""
        return replace(
            self,
            person_calibration=self.person_calibration.at_false_acceptance(false_accept_rate),
            task_calibration=self.task_calibration.at_false_acceptance(false_accept_rate),
        )

    def to_arrays(self) -> tuple[_Arrays, dict[str, Any]]:
        """Arrays and JSON-able meta from which from_arrays makes the same record."""
        arrays: _Arrays = {"centre": self.axes.centre, "axes": self.axes.axes}
        arrays |= {f.name: getattr(self.hypotheses, f.name) for f in fields(Hypotheses)}
        meta: dict[str, Any] = {"version": RECOGNISER_VERSION}
        meta |= {"persons": list(self.persons), "tasks": list(self.tasks)}
        for name in ("person", "task"):
            calibration: Calibration = getattr(self, f"{name}_calibration")
            found, meta[f"{name}_calibration"] = calibration.to_arrays(name)
            arrays |= found
        return arrays, meta

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> Recogniser:
        """The record that to_arrays took apart. Raises ValueError on another version."""
        if meta["version"] != RECOGNISER_VERSION:
            raise ValueError(f"recogniser of version {meta['version']}")
        return cls(
            tuple(meta["persons"]),
            tuple(meta["tasks"]),
            PrincipalAxes(arrays["centre"], arrays["axes"]),
            Hypotheses(**{f.name: arrays[f.name] for f in fields(Hypotheses)}),
            Calibration.from_arrays("person", arrays, meta["person_calibration"]),
            Calibration.from_arrays("task", arrays, meta["task_calibration"]),
        )


def fit_recogniser(
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    groups: Sequence[str] | None = None,
) -> Recogniser:
    """Fit on motion samples (clips, 1250) with their labels, None where there is none.

    groups: (clips,) clips of one recording share a value and are held out together.
    Raises NotEnoughLabels below two labelled clips.
    """
    use = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if any(labels)]
    if len(use) < 2:
        raise NotEnoughLabels("Recognition needs at least two clips with a person or a task.")
    persons, tasks = [persons[i] for i in use], [tasks[i] for i in use]
    together = [groups[i] if groups is not None else str(i) for i in use]
    axes = principal_axes(np.asarray(samples)[use], DIMENSIONS)
    points = axes.project(np.asarray(samples)[use])
    cells = find_cells(persons, tasks)
    person, task = _calibrations(points, persons, tasks, together, cells)
    return Recogniser(cells.persons, cells.tasks, axes, fit_hypotheses(points, cells), person, task)


def recognise(
    record: Recogniser,
    sample: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> Recognition:
    """Who does what in one motion sample (1250,), given what the asker knows.

    A known label that the library lacks is taken at its word: someone, or something, new.
    """
    return recognise_many(record, np.asarray(sample)[None], known_person, known_task)[0]


def recognise_many(
    record: Recogniser,
    samples: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> list[Recognition]:
    """`recognise` for each of `samples` (n, 1250)."""
    h = record.hypotheses
    logs = h.log_likelihoods(record.axes.project(samples))
    logs = _ruled_out(logs, h.person, record.persons, known_person)
    logs = _ruled_out(logs, h.task, record.tasks, known_task)
    who = _answers(logs, h.person, record.persons, record.person_calibration, known_person)
    what = _answers(logs, h.task, record.tasks, record.task_calibration, known_task)
    return [Recognition(person, task) for person, task in zip(who, what, strict=True)]


def label_evidence(logs: FloatArray, label: IntArray, labels: int) -> FloatArray:
    """(n, labels) log of the summed densities of the hypotheses naming each label.

    logs: (n, h); label: (h,), -1 for new. Each label is named at least once.
    """
    order = np.argsort(label, kind="stable")
    order = order[label[order] >= 0]
    starts = np.searchsorted(label[order], np.arange(labels))
    return np.asarray(np.logaddexp.reduceat(logs[:, order], starts, axis=1))


def novelty(logs: FloatArray, label: IntArray) -> FloatArray:
    """(n,) log evidence that the label is a new one, less that it is a known one."""
    new = label < 0
    said_new = np.logaddexp.reduce(logs[:, new], axis=1)
    return np.asarray(said_new - np.logaddexp.reduce(logs[:, ~new], axis=1))


def _ruled_out(
    logs: FloatArray, label: IntArray, names: tuple[str, ...], known: str | None
) -> FloatArray:
    """`logs` (n, h) without the hypotheses that name another label than the known one."""
    if known is None:
        return logs
    index = names.index(known) if known in names else NEW
    return np.where((label == index) | (label == NEW), logs, -np.inf)


def _answers(
    logs: FloatArray,
    label: IntArray,
    names: tuple[str, ...],
    calibration: Calibration,
    known: str | None,
) -> list[Answer]:
    if known is not None or not names:
        return [given(known or "", names)] * len(logs)
    new = novelty(logs, label)
    beliefs = calibration.beliefs(label_evidence(logs, label, len(names)), new)
    beyond = (new - calibration.threshold) / calibration.scale
    return [
        answer(names, row, bool(n <= 0), float(n)) for row, n in zip(beliefs, beyond, strict=True)
    ]


_HeldOut = tuple[FloatArray, FloatArray, IntArray, BoolArray]
"""evidence (n, labels), novelty (n,), truth (n,), seen (n,), as app.models.calibration has them."""


def _calibrations(
    points: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    groups: Sequence[str],
    cells: Cells,
) -> tuple[Calibration, Calibration]:
    """For persons and for tasks, from rounds that hold out clips, persons and tasks."""
    of_persons, of_tasks = [], []
    for held, train, probe in rounds(persons, tasks, groups):
        seen = find_cells([persons[i] for i in train], [tasks[i] for i in train])
        h = fit_hypotheses(points[train], seen)
        logs = h.log_likelihoods(points[probe])
        who, what = [persons[i] for i in probe], [tasks[i] for i in probe]
        pairs = {(persons[i], tasks[i]) for i in train}
        again = np.array([pair in pairs for pair in zip(who, what, strict=True)], dtype=bool)
        if held is not Held.TASKS:
            of_persons.append(_held_out(logs, h.person, seen.persons, who, cells.persons, again))
        # A stranger's walk is a walk: persons held out count as known tasks.
        of_tasks.append(_held_out(logs, h.task, seen.tasks, what, cells.tasks, again))
    # The same person at another task looks as new as another person does: persons are judged
    # by all; tasks by those who did them before, at the cost of strangers, whose walk is more
    # often called unknown, though `walk` stays its best candidate.
    return (
        _calibrated(of_persons, len(cells.persons), by_seen=False),
        _calibrated(of_tasks, len(cells.tasks), by_seen=True),
    )


def _held_out(
    logs: FloatArray,
    label: IntArray,
    seen: tuple[str, ...],
    truth: Sequence[str | None],
    names: tuple[str, ...],
    again: BoolArray,
) -> _HeldOut:
    """What a round said of its labelled probes; labels not `seen` have no evidence."""
    has = np.array([bool(name) for name in truth], dtype=bool)
    if not seen or not has.any():
        return _nothing(len(names))
    evidence = np.full((int(has.sum()), len(names)), -np.inf)
    columns = [names.index(name) for name in seen]
    evidence[:, columns] = label_evidence(logs[has], label, len(seen))
    index = [names.index(name) if name in seen else NEW for name in truth if name]
    return evidence, novelty(logs[has], label), np.array(index, dtype=np.int64), again[has]


def _calibrated(held: list[_HeldOut], labels: int, *, by_seen: bool) -> Calibration:
    parts = zip(_nothing(labels), *held, strict=True)
    evidence, new, truth, again = (np.concatenate(part) for part in parts)
    return fit_calibration(evidence, new, truth, again if by_seen else None)


def _nothing(labels: int) -> _HeldOut:
    return (
        np.zeros((0, labels)),
        np.zeros(0),
        np.zeros(0, dtype=np.int64),
        np.zeros(0, dtype=bool),
    )
