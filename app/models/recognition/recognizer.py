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
from app.models.recognition.answers import Answer, Recognition, answer, given
from app.models.recognition.calibration import Calibration, no_calibration
from app.models.recognition.copies import ClipCopies, CopiedClips
from app.models.recognition.held_out_evidence import Labeled, calibrations
from app.models.recognition.reach import allowance, nearest_cells, reach_of, recorded_cells
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
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes

RECOGNIZER_VERSION = 6

MOSTLY_REPEATED = 0.5
"""The takes of a library count as repeated if at least this share of its clips has another clip of
the same person at the same task."""

MAX_FOR_AXES = 2000
"""Largest number of clips, evenly spread, from which the axes of the views are learned. The
hypotheses are learned from all clips."""

AT_ONCE = 256
"""Clips that are compared with all hypotheses at once. It bounds the memory."""

_Arrays = dict[str, np.ndarray[Any, Any]]


@dataclass(frozen=True, slots=True)
class Recognizer:
    """A fitted recognizer.

    persons, tasks: sorted labels; label indices refer to them. sample, wide: the two views;
    their hypotheses have the same kinds and labels in the same order. persons_by_both: whether
    both views decide that a person is new (see LogDensities). allowed_persons, allowed_tasks: (h,)
    what the hypotheses of recorded cells allow their clips (app.models.recognition.reach), 0 for
    the others.
    """

    persons: tuple[str, ...]
    tasks: tuple[str, ...]
    sample: View
    wide: View
    persons_by_both: bool
    person_calibration: Calibration
    task_calibration: Calibration
    allowed_persons: FloatArray
    allowed_tasks: FloatArray

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
        arrays |= {name: getattr(self, name) for name in ("allowed_persons", "allowed_tasks")}
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
            arrays["allowed_persons"],
            arrays["allowed_tasks"],
        )


def fit_recognizer(
    samples: FloatArray,
    persons: Sequence[str | None],
    tasks: Sequence[str | None],
    groups: Sequence[str] | None = None,
    copies: ClipCopies | None = None,
    sample_length: int = SAMPLE_LENGTH,
    *,
    is_calibrated: bool = True,
) -> Recognizer:
    """Fit on full samples with their labels (None: no label).

    samples: (clips, 1762); each is a motion sample of `sample_length` (1250), followed by the wide
    motion vector of the clip; groups: (clips,) clips of one recording share a value and are held
    out together; copies: (clips,) the disturbed copies of some clips. Without copies, a clip with
    noise or another speed is often called unknown. is_calibrated: False leaves out the calibration
    on held-out clips, which takes most of the time; the candidates are then in the right order,
    but scores and the decision on what is unknown have no meaning. Raises NotEnoughLabels with
    fewer than two labeled clips.
    """
    use = [i for i, labels in enumerate(zip(persons, tasks, strict=True)) if any(labels)]
    if len(use) < 2:
        raise NotEnoughLabels("Recognition needs at least two clips with a person or a task.")
    persons, tasks = [persons[i] for i in use], [tasks[i] for i in use]
    together = [groups[i] if groups is not None else str(i) for i in use]
    rows = both_views(np.asarray(samples)[use], sample_length)
    cells = find_cells(persons, tasks)
    spread = np.linspace(0, len(use) - 1, min(len(use), MAX_FOR_AXES))
    some = rows.of(spread.round().astype(np.int64))
    sample = principal_axes(some.sample, SAMPLE_DIMENSIONS)
    wide = principal_axes(some.wide, wide_dimensions(len(cells)))
    points = BothViews(sample.project(rows.sample), wide.project(rows.wide))
    own_copies = [copies[i] for i in use] if copies is not None else []
    copied = _copied(points, own_copies, (sample, wide), sample_length)
    clips = Labeled(points, persons, tasks, together, copied)
    hypotheses = clips.hypotheses(np.arange(len(use)))
    by_both = int(cells.takes[cells.takes > 1].sum()) < MOSTLY_REPEATED * len(use)
    views = View(sample, hypotheses[0]), View(wide, hypotheses[1])
    if not is_calibrated:
        allowed = np.zeros((2, len(hypotheses[1].kind)))
        none = no_calibration()
        return Recognizer(cells.persons, cells.tasks, *views, by_both, none, none, *allowed)
    person, task = calibrations(clips, hypotheses, persons_by_both=by_both)
    recorded = recorded_cells(hypotheses[1])
    reach = reach_of(hypotheses, recorded, persons_by_both=by_both)
    allowed = np.zeros((2, len(hypotheses[1].kind)))
    allowed[0, recorded] = allowance(person.threshold, reach.person)
    allowed[1, recorded] = allowance(task.threshold, reach.task)
    return Recognizer(cells.persons, cells.tasks, *views, by_both, person, task, *allowed)


def _copied(
    points: BothViews, copies: ClipCopies, axes: tuple[PrincipalAxes, PrincipalAxes], length: int
) -> CopiedClips | None:
    """The `copies` of the clips at `points` (n, d), in the coordinates of `axes`; None if none."""
    index = [i for i, own in enumerate(copies) if own is not None]
    if not index:
        return None
    by_clip = [both_views(own, length) for own in copies if own is not None]
    sample, wide = (
        np.stack([own.project(each[view]) for each in by_clip]) for view, own in enumerate(axes)
    )
    return CopiedClips(points, np.array(index), BothViews(sample, wide))


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
    nearest = nearest_cells(logs.ranking, h)
    new_person = newness(logs.new_person, h.person) - record.allowed_persons[nearest]
    new_task = newness(logs.new_task, h.task) - record.allowed_tasks[nearest]
    of_factor = record.persons, record.person_calibration, known_person
    who = _answers(logs.ranking, new_person, h.person, *of_factor)
    of_factor = record.tasks, record.task_calibration, known_task
    what = _answers(logs.ranking, new_task, h.task, *of_factor)
    return [Recognition(person, task) for person, task in zip(who, what, strict=True)]


def likeliest(record: Recognizer, samples: FloatArray) -> list[tuple[str | None, str | None]]:
    """The best person and the best task for each of `samples` (n, 1762); None without candidates.

    They are the first candidates of `recognize_many`, without scores and novelties. The calibration
    does not change which candidate is the best, so an uncalibrated recognizer will do.
    """
    found: list[tuple[str | None, str | None]] = []
    for first in range(0, len(samples), AT_ONCE):
        rows = both_views(samples[first : first + AT_ONCE], len(record.sample.axes.center))
        sample, wide = record.sample, record.wide
        points = BothViews(sample.axes.project(rows.sample), wide.axes.project(rows.wide))
        h = wide.hypotheses
        ranking = LogDensities.ranking_under(sample.hypotheses, h, points)
        who = _best(ranking, h.person, record.persons)
        found += zip(who, _best(ranking, h.task, record.tasks), strict=True)
    return found


def _best(ranking: FloatArray, label: IntArray, names: tuple[str, ...]) -> Sequence[str | None]:
    if not names:
        return [None] * len(ranking)
    return [names[best] for best in evidence(ranking, label, len(names)).argmax(axis=1)]


def _answers(
    ranking: FloatArray,
    novelty: FloatArray,
    label: IntArray,
    names: tuple[str, ...],
    calibration: Calibration,
    known: str | None,
) -> list[Answer]:
    """The answers for n clips.

    ranking: (n, h) log densities that rank labels; novelty: (n,) less what the nearest cells allow;
    label: (h,) of the hypotheses; known: the label that the caller knows.
    """
    if known is not None or not names:
        return [given(known or "", names)] * len(ranking)
    beliefs = calibration.beliefs(evidence(ranking, label, len(names)), novelty)
    beyond = (novelty - calibration.threshold) / calibration.scale
    return [
        answer(names, row, bool(n <= 0), float(n)) for row, n in zip(beliefs, beyond, strict=True)
    ]
