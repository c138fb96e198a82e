"""The default recognizer: which person does which task, or whether the person or task is new.

A clip has two views (app.models.recognition.views). Each is projected to PCA coordinates and
compared with all hypotheses (app.models.recognition.hypotheses). The evidence of a label is the sum
of the densities of its hypotheses. The novelty is the log ratio of the densities of the hypotheses
of a new label to those of the others. It separates new from known clips better than the distance to
the nearest cell divided by the radius of that cell. Both are calibrated on clips, persons and tasks
that are held out of the fit.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLE_LENGTH
from app.errors import NotEnoughLabels
from app.models.cells import find_cells
from app.models.holding_out import MAX_PROBES, HeldOut, rounds
from app.models.recognition.answers import Answer, Recognition, answer, given
from app.models.recognition.calibration import NEW, Calibration, fit_calibration
from app.models.recognition.hypotheses import fit_hypotheses
from app.models.recognition.views import (
    SAMPLE_DIMENSIONS,
    BothViews,
    LogDensities,
    View,
    both_views,
    evidence,
    newness,
    wide_dimensions,
)
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.principal_axes import principal_axes

RECOGNIZER_VERSION = 3

MOSTLY_REPEATED = 0.5
"""The takes of a library count as repeated if at least this share of its clips has another clip of
the same person at the same task."""

SIMULATED_TAKES = 3
"""Number of simulated takes of each cell. They calibrate the novelty if takes are not repeated."""

_Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, slots=True)
class Recognizer:
    """A fitted recognizer.

    persons, tasks: sorted labels; label indices refer to them. sample, wide: the two views;
    their hypotheses have the same kinds and labels in the same order. persons_by_both: whether
    both views decide that a person is new (see LogDensities).
    """

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    sample: View
    wide: View
    persons_by_both: bool
    person_calibration: Calibration
    task_calibration: Calibration

    def accepting(self, false_accept_rate: float) -> Recognizer:
        """The same recognizer with another threshold.

        At most the share `false_accept_rate` (0..1) of new held-out clips is then called known.
        """
        return replace(
            self,
            person_calibration=self.person_calibration.at_false_acceptance(false_accept_rate),
            task_calibration=self.task_calibration.at_false_acceptance(false_accept_rate),
        )

    def to_arrays(self) -> tuple[_Arrays, dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        arrays = self.sample.to_arrays("sample") | self.wide.to_arrays("wide")
        meta: dict[str, Any] = {"version": RECOGNIZER_VERSION}
        meta |= {"persons": list(self.persons), "tasks": list(self.tasks)}
        meta["persons_by_both"] = self.persons_by_both
        for name in ("person", "task"):
            calibration: Calibration = getattr(self, f"{name}_calibration")
            own, meta[f"{name}_calibration"] = calibration.to_arrays(name)
            arrays |= own
        return arrays, meta

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, Any], meta: Mapping[str, Any]) -> Recognizer:
        """The recognizer from the result of `to_arrays`. Raises ValueError on another version."""
        if meta["version"] != RECOGNIZER_VERSION:
            raise ValueError(f"recognizer of version {meta['version']}")
        return cls(
            tuple(meta["persons"]),
            tuple(meta["tasks"]),
            View.from_arrays("sample", arrays),
            View.from_arrays("wide", arrays),
            bool(meta["persons_by_both"]),
            Calibration.from_arrays("person", arrays, meta["person_calibration"]),
            Calibration.from_arrays("task", arrays, meta["task_calibration"]),
        )


def fit_recognizer(
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    groups: Sequence[str] | None = None,
    sample_length: int = SAMPLE_LENGTH,
) -> Recognizer:
    """Fit on full samples with their labels (None: no label).

    samples: (clips, 1762); each is a motion sample of `sample_length` (1250), followed by the wide
    motion vector of the clip; groups: (clips,) clips of one recording share a value and are held
    out together. Raises NotEnoughLabels with fewer than two labeled clips.
    """
    use = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if any(labels)]
    if len(use) < 2:
        raise NotEnoughLabels("Recognition needs at least two clips with a person or a task.")
    persons, tasks = [persons[i] for i in use], [tasks[i] for i in use]
    together = [groups[i] if groups is not None else str(i) for i in use]
    rows = both_views(np.asarray(samples)[use], sample_length)
    cells = find_cells(persons, tasks)
    sample = principal_axes(rows.sample, SAMPLE_DIMENSIONS)
    wide = principal_axes(rows.wide, wide_dimensions(len(cells)))
    points = BothViews(sample.project(rows.sample), wide.project(rows.wide))
    views = (
        View(sample, fit_hypotheses(points.sample, cells)),
        View(wide, fit_hypotheses(points.wide, cells)),
    )
    repeated = int(cells.takes[cells.takes > 1].sum())
    by_both = repeated < MOSTLY_REPEATED * len(use)
    person, task = _calibrations(points, persons, tasks, together, views, by_both)
    return Recognizer(cells.persons, cells.tasks, *views, by_both, person, task)


def recognize(
    record: Recognizer,
    sample: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> Recognition:
    """Recognize who does what in one full sample (1762,).

    known_person, known_task: the label that the caller knows. A known label that the library
    does not have counts as a new person or task.
    """
    return recognize_many(record, np.asarray(sample)[None], known_person, known_task)[0]


def recognize_many(
    record: Recognizer,
    samples: FloatArray,
    known_person: str | None = None,
    known_task: str | None = None,
) -> list[Recognition]:
    """`recognize` for each of `samples` (n, 1762)."""
    rows = both_views(samples, len(record.sample.axes.center))
    sample, wide = record.sample, record.wide
    points = BothViews(sample.axes.project(rows.sample), wide.axes.project(rows.wide))
    h = wide.hypotheses
    logs = LogDensities.under(sample.hypotheses, h, points, persons_by_both=record.persons_by_both)
    logs = logs.without_others(h.person, record.persons, known_person)
    logs = logs.without_others(h.task, record.tasks, known_task)
    of_factor = record.persons, record.person_calibration, known_person
    who = _answers(logs.ranking, logs.new_person, h.person, *of_factor)
    of_factor = record.tasks, record.task_calibration, known_task
    what = _answers(logs.ranking, logs.new_task, h.task, *of_factor)
    return [Recognition(person, task) for person, task in zip(who, what, strict=True)]


def _answers(
    ranking: FloatArray,
    novelty: FloatArray,
    label: IntArray,
    names: tuple[str, ...],
    calibration: Calibration,
    known: str | None,
) -> list[Answer]:
    """Answers from two arrays of log densities (n, h).

    ranking: ranks labels; novelty: decides whether the label is new; label: (h,) of the
    hypotheses; known: the label that the caller knows.
    """
    if known is not None or not names:
        return [given(known or "", names)] * len(ranking)
    new = newness(novelty, label)
    beliefs = calibration.beliefs(evidence(ranking, label, len(names)), new)
    beyond = (new - calibration.threshold) / calibration.scale
    return [
        answer(names, row, bool(n <= 0), float(n)) for row, n in zip(beliefs, beyond, strict=True)
    ]


_HeldOutResults = tuple[FloatArray, FloatArray, IntArray, BoolArray]
"""evidence (n, labels), novelty (n,), truth (n,), seen (n,), as `calibration` has them."""


def _calibrations(
    points: BothViews,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    groups: Sequence[str],
    views: tuple[View, View],
    persons_by_both: bool,
) -> tuple[Calibration, Calibration]:
    """The calibrations for persons and for tasks.

    They come from rounds that hold out clips, persons and tasks, and from simulated takes of the
    `views` of all clips.
    """
    of_persons, of_tasks = [], []
    names = [tuple(sorted({label for label in labels if label})) for labels in (persons, tasks)]
    for kind, train, probe in rounds(persons, tasks, groups):
        seen = find_cells([persons[i] for i in train], [tasks[i] for i in train])
        sample, h = (fit_hypotheses(part, seen) for part in points.of(train))
        logs = LogDensities.under(sample, h, points.of(probe), persons_by_both=persons_by_both)
        who, what = [persons[i] for i in probe], [tasks[i] for i in probe]
        pairs = {(persons[i], tasks[i]) for i in train}
        seen_before = np.array([pair in pairs for pair in zip(who, what, strict=True)], dtype=bool)
        # rounds that hold out tasks calibrate only the tasks
        if kind is not HeldOut.TASKS:
            new = newness(logs.new_person, h.person)
            ranked = logs.ranking, h.person, seen.persons
            of_persons.append(_held_out(*ranked, new, who, names[0], seen_before))
        # the task of a new person can be known: held-out persons count as known tasks
        new = newness(logs.new_task, h.task)
        of_tasks.append(
            _held_out(logs.ranking, h.task, seen.tasks, new, what, names[1], seen_before)
        )
    # The error rates are those of clips with a recorded pair of person and task. So a task of a new
    # person may be called unknown (with the right best candidate), except if there is a gap between
    # new and known tasks.
    sample, h = (view.hypotheses for view in views)
    further = BothViews(*(each.further_takes(SIMULATED_TAKES, MAX_PROBES) for each in (sample, h)))
    simulated = LogDensities.under(sample, h, further, persons_by_both=persons_by_both)
    return (
        _calibrated(of_persons, len(names[0]), newness(simulated.new_person, h.person)),
        _calibrated(of_tasks, len(names[1]), newness(simulated.new_task, h.task)),
    )


def _held_out(
    ranking: FloatArray,
    label: IntArray,
    seen: tuple[str, ...],
    new: FloatArray,
    truth: Sequence[str | None],
    names: tuple[str, ...],
    seen_before: BoolArray,
) -> _HeldOutResults:
    """The results of a round for its labeled probes.

    seen: the labels of the training clips; the other labels get no evidence. seen_before: (n,)
    whether the training clips have person and task of the probe together.
    """
    has = np.array([bool(name) for name in truth], dtype=bool)
    if not seen or not has.any():
        return _no_results(len(names))
    by_label = np.full((int(has.sum()), len(names)), -np.inf)
    by_label[:, [names.index(name) for name in seen]] = evidence(ranking[has], label, len(seen))
    index = [names.index(name) if name in seen else NEW for name in truth if name]
    return by_label, new[has], np.array(index, dtype=np.int64), seen_before[has]


def _calibrated(held: list[_HeldOutResults], labels: int, simulated: FloatArray) -> Calibration:
    parts = zip(_no_results(labels), *held, strict=True)
    by_label, new, truth, seen_before = (np.concatenate(part) for part in parts)
    return fit_calibration(by_label, new, truth, seen_before, simulated)


def _no_results(labels: int) -> _HeldOutResults:
    return (
        np.zeros((0, labels)),
        np.zeros(0),
        np.zeros(0, dtype=np.int64),
        np.zeros(0, dtype=bool),
    )
