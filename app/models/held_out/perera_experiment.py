"""Perera's experiments (2009, section 5.4) on any dances: known and alien persons and tasks.

The model is trained on one cycle and probed with another (Table 3). With persons or tasks that the
tensor does not have (Tables 4 and 5), a second cycle of the training segments gives the usual
objective in another cycle: F*_k (eq. 15) of each category k. A probe is new if its F*_Pr (eq. 16)
is not within thresholds of F*_k.

Reading.PRINTED: eq. 14 maximized, and a category holds what lies within the range of its F*_k,
which makes new what is nearer than the trained cycle ever was. Reading.LEAST minimizes
(see app.models.recognition.task_model), has no lower side, and takes for F*_k the mean over the
category's segments; in Table 5 the largest of a task's segments from those of its other dancers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.held_out.danced_tasks import DancedTasks
from app.models.recognition.task_model import Reading, TaskModel, fit_task_model, objective
from app.numerics.arrays import BoolArray, FloatArray, IntArray

NEW_THRESHOLD = 0.05
"""Relative threshold of F*_k and F*_Pr for deciding whether a probe is new (Table 4)."""

NAMED_THRESHOLD = 0.12
"""Relative threshold of both for naming the label of a probe (Table 5)."""

MAX_ROUNDS = 3
"""Number of choices of the training cycle."""

MAX_LEFT_OUT = 12
"""Largest number of persons, or tasks, that are left out in turn in one round."""

MIN_LABELS = 2
"""Persons and tasks that are needed, also after some are left out."""


@dataclass(frozen=True, slots=True)
class Row:
    """A line of the paper's Tables 3-5: segments probed and recognized, over all rounds.

    paper: the accuracy printed in the paper; known_probed, known_accepted: only in Table 4, the
    numbers of segments of known persons (tasks) that were probed, and that were called known.
    """

    table: int
    category: str
    reading: Reading
    probed: int
    correct: int
    paper: float
    known_probed: int = 0
    known_accepted: int = 0

    @property
    def accuracy(self) -> float:
        """Share recognized, 0..1."""
        return self.correct / max(self.probed, 1)

    @property
    def balanced_accuracy(self) -> float:
        """The mean of `accuracy` and the share of known segments that were accepted (Table 4)."""
        return 0.5 * (self.accuracy + self.known_accepted / max(self.known_probed, 1))


def perera_tables(danced: DancedTasks, reading: Reading = Reading.LEAST) -> tuple[Row, ...]:
    """Tables 3, 4 and 5 of the paper, in its order.

    Table 3 needs segments with two cycles, Tables 4 and 5 segments with three. Tables 4 and 5
    leave out each person and each task in turn (at most MAX_LEFT_OUT).
    Raises NotEnoughLabels without two persons and two tasks with two cycles each.
    """
    tables: dict[str, Row] = {}
    for found in (*_known(danced, reading), *_alien(danced, reading)):
        tables[found.category] = _sum(tables.get(found.category), found)
    return tuple(sorted(tables.values(), key=lambda row: (row.table, -row.paper)))


def _sum(one: Row | None, other: Row) -> Row:
    if one is None:
        return other
    return Row(
        one.table,
        one.category,
        one.reading,
        one.probed + other.probed,
        one.correct + other.correct,
        one.paper,
        one.known_probed + other.known_probed,
        one.known_accepted + other.known_accepted,
    )


def _known(danced: DancedTasks, reading: Reading) -> Iterator[Row]:
    """Table 3, a round for each choice of the training cycle."""
    use = _with_cycles(danced, 2)
    if min(len(set(use.persons)), len(set(use.tasks))) < MIN_LABELS:
        raise NotEnoughLabels(
            "Perera's experiment needs two persons who do the same two tasks twice each, "
            "in one clip or in two clips."
        )
    for train, probe in ((0, 1), (1, 0)):
        model = _fit(use.part(use.cycle == train))
        probes = use.part(use.cycle == probe)
        distances = model.joint_distances(probes.poses)
        for view, paper in ((_tasks(model), 0.9791), (_persons(model), 0.875)):
            truth = view.labels_of(probes)
            best = view.objective(distances, reading).argmin(axis=1)
            correct = sum(view.names[b] == t for b, t in zip(best, truth, strict=True))
            yield Row(3, f"{view.what} recognition", reading, len(truth), correct, paper)


def _alien(danced: DancedTasks, reading: Reading) -> Iterator[Row]:
    """Tables 4 and 5, a round for each choice of the three cycles."""
    use = _with_cycles(danced, 3)
    for first in range(MAX_ROUNDS):
        train, again, probe = ((use.cycle == (first + k) % 3) for k in range(3))
        for person in _left_out(use.persons):
            stays = np.array([name != person for name in use.persons])
            trained = _Trained.on(use.part(train & stays), use.part(again & stays))
            new, known = use.part(probe & ~stays), use.part(probe & stays)
            yield trained.new_ones("person", new, known, reading)
            yield trained.named("task recognition of alien person", new, reading)
            yield trained.named("task recognition of known person", known, reading)
        for task in _left_out(use.tasks):
            stays = np.array([name != task for name in use.tasks])
            trained = _Trained.on(use.part(train & stays), use.part(again & stays))
            yield trained.new_ones(
                "task", use.part(probe & ~stays), use.part(probe & stays), reading
            )


def _with_cycles(danced: DancedTasks, least: int) -> DancedTasks:
    """The segments of each person and task that have at least `least` cycles."""
    pairs = list(zip(danced.persons, danced.tasks, strict=True))
    last = {pair for pair, cycle in zip(pairs, danced.cycle, strict=True) if cycle == least - 1}
    return danced.part(np.array([pair in last for pair in pairs], dtype=bool))


def _left_out(labels: Sequence[str]) -> list[str]:
    """The labels to leave out in turn, evenly chosen; none if too few would remain."""
    names = sorted(set(labels))
    if len(names) <= MIN_LABELS:
        return []
    chosen = np.linspace(0, len(names) - 1, min(len(names), MAX_LEFT_OUT)).round()
    return [names[int(i)] for i in np.unique(chosen)]


def _fit(danced: DancedTasks) -> TaskModel:
    return fit_task_model(danced.poses, danced.persons, danced.tasks)


@dataclass(frozen=True, slots=True)
class _View:
    """The tensor flattened along persons or tasks. label: (c,) of the model's cells."""

    what: str
    names: tuple[str, ...]
    label: IntArray
    weights: FloatArray

    def objective(self, distances: FloatArray, reading: Reading) -> FloatArray:
        """(n, names) objectives of joint distances (n, c, 13); the smallest is the best."""
        return objective(distances, self.label, len(self.names), self.weights, reading)

    def labels_of(self, danced: DancedTasks) -> tuple[str, ...]:
        """(n,) the true label of each segment."""
        return danced.tasks if self.what == "task" else danced.persons

    def index(self, danced: DancedTasks) -> IntArray:
        """(n,) the true labels as indices into `names`, which has them all."""
        return np.array([self.names.index(name) for name in self.labels_of(danced)], np.int64)


def _tasks(model: TaskModel) -> _View:
    return _View("task", model.tasks, model.task, model.weights)


def _persons(model: TaskModel) -> _View:
    return _View("person", model.persons, model.person, model.weights)


@dataclass(frozen=True, slots=True)
class _Trained:
    """A model, and the distances (n, c, 13) of the repeated segments `again` (n,)."""

    model: TaskModel
    again: DancedTasks
    distances: FloatArray

    @classmethod
    def on(cls, first: DancedTasks, again: DancedTasks) -> _Trained:
        model = _fit(first)
        return cls(model, again, model.joint_distances(again.poses))

    def new_ones(self, what: str, new: DancedTasks, known: DancedTasks, reading: Reading) -> Row:
        """A row of Table 4: segments of new labels, and segments of known labels."""
        view, paper = (
            (_tasks(self.model), 0.9166) if what == "task" else (_persons(self.model), 0.8333)
        )
        accepted = [
            self._within(view, part, NEW_THRESHOLD, reading)[0].any(axis=1) for part in (new, known)
        ]
        return Row(
            4,
            f"new {what} recognition",
            reading,
            len(new),
            int((~accepted[0]).sum()),
            paper,
            len(known),
            int(accepted[1].sum()),
        )

    def named(self, category: str, probes: DancedTasks, reading: Reading) -> Row:
        """A row of Table 5: a segment counts if the nearest task within thresholds is right."""
        view = _tasks(self.model)
        within, far = self._within(view, probes, NAMED_THRESHOLD, reading)
        best = np.where(within, far, np.inf).argmin(axis=1)
        right = [
            within[row].any() and view.names[label] == truth
            for row, (label, truth) in enumerate(zip(best.tolist(), probes.tasks, strict=True))
        ]
        paper = 0.8333 if "alien" in category else 0.9166
        return Row(5, category, reading, len(probes), int(np.sum(right)), paper)

    def _within(
        self, view: _View, probes: DancedTasks, threshold: float, reading: Reading
    ) -> tuple[BoolArray, FloatArray]:
        """(n, names) whether F*_Pr is within thresholds of F*_k, and (n, names) the objectives
        of eq. 16; the smallest is the best."""
        low, high = self._trained(view, reading, of_others=threshold == NAMED_THRESHOLD)
        signed = view.objective(self.model.joint_distances(probes.poses), reading)
        value = np.abs(signed)
        within = value * (1 - threshold) <= high * (1 + threshold)
        if reading is Reading.PRINTED:
            within &= value * (1 + threshold) >= low * (1 - threshold)
        return within, signed

    def _trained(
        self, view: _View, reading: Reading, *, of_others: bool
    ) -> tuple[FloatArray, FloatArray]:
        """The smallest and the largest accepted F*_k (eq. 15) for each of `names`.

        of_others: F*_k is computed between different persons who did the same task, not between
        cycles of one person, since the task of an alien person cannot be nearer.
        """
        distances, own = self.distances, view.index(self.again)
        if of_others and reading is Reading.LEAST:
            theirs = _persons(self.model).index(self.again)[:, None] == self.model.person
            distances = np.where(theirs[..., None], np.inf, distances)
        found = np.abs(view.objective(distances, reading))[np.arange(len(own)), own]
        values = [found[(own == k) & np.isfinite(found)] for k in range(len(view.names))]
        if reading is Reading.LEAST and not of_others:
            values = [each.mean(keepdims=True) if len(each) else each for each in values]
        low = np.array([each.min(initial=np.inf) for each in values])
        return low, np.array([each.max(initial=0.0) for each in values])
