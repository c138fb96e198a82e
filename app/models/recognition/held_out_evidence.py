"""Calibration of the default recognizer on clips, persons and tasks that are held out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from app.models.cells import Cells, find_cells
from app.models.holding_out import (
    MAX_PROBES,
    HeldOut,
    rounds,
    rounds_by_distance,
    rounds_of_strangers,
)
from app.models.recognition.calibration import MIN_CLIPS, NEW, Calibration, fit_calibration
from app.models.recognition.copies import CopiedClips
from app.models.recognition.hypotheses import Hypotheses, fit_hypotheses
from app.models.recognition.mirrored_cells import mirrored_cells
from app.models.recognition.reach import allowance, nearest_cells, reach_of
from app.models.recognition.views import BothViews, LogDensities, evidence, newness
from app.numerics.arrays import BoolArray, FloatArray, IntArray

SIMULATED_TAKES = 3
"""Number of simulated takes of each cell. They calibrate the novelty if takes are not repeated."""

Labels = Sequence[str | None]


class Labeled(NamedTuple):
    """n labeled clips in both views: points (n, d), labels (n,).

    groups: (n,) clips of one recording share a value; copied: those with copies; None without any.
    """

    points: BothViews
    persons: Labels
    tasks: Labels
    groups: Sequence[str]
    copied: CopiedClips | None

    def cells(self, index: IntArray) -> Cells:
        """The cells of the clips at these indices."""
        return find_cells(*self.labels(index))

    def labels(self, index: IntArray) -> tuple[list[str | None], list[str | None]]:
        """The persons and the tasks of the clips at these indices."""
        return [self.persons[i] for i in index], [self.tasks[i] for i in index]

    def hypotheses(self, index: IntArray) -> tuple[Hypotheses, Hypotheses]:
        """The hypotheses of both views, learned from the clips at these indices."""
        cells = self.cells(index)
        points = self.points.of(index)
        if self.copied is None:
            return fit_hypotheses(points.sample, cells), fit_hypotheses(points.wide, cells)
        which, copies = self.copied.mirrored(index)
        labels = self.labels(which)
        sample, wide = (
            fit_hypotheses(part, cells, moments, mirrored_cells(turned, *labels, cells))
            for part, moments, turned in zip(
                points, self.copied.moments(index), copies, strict=True
            )
        )
        return sample, wide


def calibrations(
    clips: Labeled, views: tuple[Hypotheses, Hypotheses], *, persons_by_both: bool
) -> tuple[Calibration, Calibration]:
    """The calibrations for persons and for tasks.

    They come from rounds that hold out clips, persons, tasks, and both of these at once, and from
    simulated takes of the `views` of all clips. If clips are held out, a light copy of each counts
    like the clip. If there are enough takes that are far apart, only these say how novel a later
    take of a known pair is: a take between two learned ones is more like them.
    """
    names = [
        tuple(sorted({label for label in labels if label}))
        for labels in (clips.persons, clips.tasks)
    ]
    of_persons, of_tasks = [], []
    labels = clips.persons, clips.tasks
    far = list(rounds_by_distance(*labels, clips.groups))
    enough = sum(len(probe) for _, _, probe in far) >= MIN_CLIPS
    for kind, train, probe in (
        *rounds(*labels, clips.groups),
        *rounds_of_strangers(*labels),
        *(far if enough else ()),
    ):
        judge = _Judge(clips, train, persons_by_both)
        asked = [(probe, clips.points.of(probe))]
        if kind in (HeldOut.CLIPS, HeldOut.FAR) and clips.copied:
            asked.append(clips.copied.one_each(probe))
        for index, points in asked:
            person, task = judge.results(index, points, names)
            if enough and kind is HeldOut.CLIPS:
                person, task = (
                    one._replace(seen=np.zeros_like(one.seen)) for one in (person, task)
                )
            # rounds that hold out tasks calibrate only the tasks
            if kind is not HeldOut.TASKS:
                of_persons.append(person)
            # the task of a new person can be known: held-out persons count as known tasks
            of_tasks.append(task)
    # The error rates are those of clips with a recorded pair of person and task. So a task of a new
    # person may be called unknown (with the right best candidate), except if there is a gap between
    # new and known tasks.
    sample, h = views
    further = BothViews(*(each.further_takes(SIMULATED_TAKES, MAX_PROBES) for each in views))
    logs = LogDensities.under(sample, h, further, persons_by_both=persons_by_both)
    reach = reach_of(views, nearest_cells(logs.ranking, h), persons_by_both=persons_by_both)
    return (
        _calibrated(of_persons, len(names[0]), newness(logs.new_person, h.person), reach.person),
        _calibrated(of_tasks, len(names[1]), newness(logs.new_task, h.task), reach.task),
    )


class _HeldOutResults(NamedTuple):
    """evidence (n, labels), novelty, truth and seen (n,), as `calibration` has them; reach: (n,) of
    the nearest cells."""

    evidence: FloatArray
    novelty: FloatArray
    truth: IntArray
    seen: BoolArray
    reach: FloatArray


class _Judge:
    """A model of the clips `train` of a round."""

    def __init__(self, clips: Labeled, train: IntArray, persons_by_both: bool) -> None:
        self.clips = clips
        self.seen = clips.cells(train)
        self.pairs = set(zip(*clips.labels(train), strict=True))
        self.hypotheses = clips.hypotheses(train)
        self.by_both = persons_by_both

    def results(
        self, index: IntArray, points: BothViews, names: Sequence[tuple[str, ...]]
    ) -> tuple[_HeldOutResults, _HeldOutResults]:
        """The results of persons and tasks for `points` (n, d) of the clips `index` (n,)."""
        sample, h = self.hypotheses
        logs = LogDensities.under(sample, h, points, persons_by_both=self.by_both)
        who, what = self.clips.labels(index)
        before = np.array([pair in self.pairs for pair in zip(who, what, strict=True)], dtype=bool)
        new_person, new_task = newness(logs.new_person, h.person), newness(logs.new_task, h.task)
        nearest = nearest_cells(logs.ranking, h)
        reach = reach_of(self.hypotheses, nearest, persons_by_both=self.by_both)
        seen = self.seen
        by_person = evidence(logs.ranking, h.person, len(seen.persons))
        by_task = evidence(logs.ranking, h.task, len(seen.tasks))
        return (
            _held_out(
                by_person, self.seen.persons, new_person, who, names[0], before, reach.person
            ),
            _held_out(by_task, self.seen.tasks, new_task, what, names[1], before, reach.task),
        )


def _held_out(
    by_seen: FloatArray,
    seen: tuple[str, ...],
    new: FloatArray,
    truth: Labels,
    names: tuple[str, ...],
    seen_before: BoolArray,
    reach: FloatArray,
) -> _HeldOutResults:
    """The results of a round for its labeled probes.

    by_seen: (n, seen) evidence of the labels of the training clips; the other ones of `names` get
    none. seen_before: (n,) whether the training clips have person and task of the probe together.
    """
    has = np.array([bool(name) for name in truth], dtype=bool)
    if not seen or not has.any():
        return _no_results(len(names))
    by_label = np.full((int(has.sum()), len(names)), -np.inf)
    by_label[:, [names.index(name) for name in seen]] = by_seen[has]
    index = [names.index(name) if name in seen else NEW for name in truth if name]
    truth_index = np.array(index, dtype=np.int64)
    return _HeldOutResults(by_label, new[has], truth_index, seen_before[has], reach[has])


def _calibrated(
    held: list[_HeldOutResults], labels: int, simulated: FloatArray, reach: FloatArray
) -> Calibration:
    """The calibration of novelties less what the nearest cells allow.

    What they allow depends on the threshold, which is chosen before. simulated: (m,) novelties of
    simulated takes; reach: (m,) that of their nearest cells.
    """
    parts = zip(_no_results(labels), *held, strict=True)
    found = _HeldOutResults(*(np.concatenate(part) for part in parts))
    first = fit_calibration(found.evidence, found.novelty, found.truth, found.seen, simulated)
    return fit_calibration(
        found.evidence,
        found.novelty - allowance(first.threshold, found.reach),
        found.truth,
        found.seen,
        simulated - allowance(first.threshold, reach),
        first.threshold,
    )


def _no_results(labels: int) -> _HeldOutResults:
    return _HeldOutResults(
        np.zeros((0, labels)),
        np.zeros(0),
        np.zeros(0, dtype=np.int64),
        np.zeros(0, dtype=bool),
        np.zeros(0),
    )
