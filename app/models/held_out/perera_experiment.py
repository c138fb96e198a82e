"""Perera's experiments (2009, section 5.4) on any dances: known and alien persons and tasks.

The model is trained on one cycle and probed with another (Table 3). With persons or tasks that the
tensor does not have (Tables 4 and 5), a second cycle of the training segments gives the usual
objective in another cycle: F*_k (eq. 15) of each category k. A probe is new if its F*_Pr (eq. 16)
is not within thresholds of F*_k.

Reading.PRINTED maximizes eq. 14. A category accepts values within the range of its F*_k. So a probe
that is nearer than every trained cycle counts as new. Reading.LEAST minimizes (see
app.models.recognition.task_model). It has no lower limit. Its F*_k is the mean over the segments of
the category. In Table 5, it is the largest distance of a task's segments to those of other dancers.
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
    """A row of the paper's Tables 3-5, over all rounds.

    probed, correct: numbers of segments that were probed, and recognized correctly. paper: the
    accuracy that the paper prints. known_probed, known_accepted: only in Table 4, the numbers of
    segments of known persons (tasks) that were probed, and that were called known.
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
        """Share of the probed segments that were recognized correctly, 0..1."""
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
    for row in (*_rows_of_table_3(danced, reading), *_rows_of_tables_4_and_5(danced, reading)):
        tables[row.category] = _sum(tables.get(row.category), row)
    return tuple(sorted(tables.values(), key=lambda each: (each.table, -each.paper)))


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


def _rows_of_table_3(danced: DancedTasks, reading: Reading) -> Iterator[Row]:
    """One round for each choice of the training cycle."""
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
        for factor, paper in ((_tasks(model), 0.9791), (_persons(model), 0.875)):
            truth = factor.labels_of(probes)
            best = factor.objective(distances, reading).argmin(axis=1)
            correct = sum(factor.names[b] == t for b, t in zip(best, truth, strict=True))
            yield Row(3, f"{factor.what} recognition", reading, len(truth), correct, paper)


def _rows_of_tables_4_and_5(danced: DancedTasks, reading: Reading) -> Iterator[Row]:
    """One round for each order of the three cycles, and for each left-out person and task."""
    use = _with_cycles(danced, 3)
    for first in range(MAX_ROUNDS):
        train, again, probe = ((use.cycle == (first + k) % 3) for k in range(3))
        for person in _left_out(use.persons):
            stays = np.array([name != person for name in use.persons])
            trained = _Trained.fit(use.part(train & stays), use.part(again & stays))
            new, known = use.part(probe & ~stays), use.part(probe & stays)
            yield trained.row_of_table_4("person", new, known, reading)
            yield trained.row_of_table_5("task recognition of alien person", new, reading)
            yield trained.row_of_table_5("task recognition of known person", known, reading)
        for task in _left_out(use.tasks):
            stays = np.array([name != task for name in use.tasks])
            trained = _Trained.fit(use.part(train & stays), use.part(again & stays))
            yield trained.row_of_table_4(
                "task", use.part(probe & ~stays), use.part(probe & stays), reading
            )


def _with_cycles(danced: DancedTasks, min_cycles: int) -> DancedTasks:
    """The segments of each person and task with at least `min_cycles` cycles."""
    pairs = list(zip(danced.persons, danced.tasks, strict=True))
    last = {
        pair for pair, cycle in zip(pairs, danced.cycle, strict=True) if cycle == min_cycles - 1
    }
    return danced.part(np.array([pair in last for pair in pairs], dtype=bool))


def _left_out(labels: Sequence[str]) -> list[str]:
    """The labels to leave out in turn: at most MAX_LEFT_OUT, evenly chosen.

    The list is empty if too few labels would remain.
    """
    names = sorted(set(labels))
    if len(names) <= MIN_LABELS:
        return []
    chosen = np.linspace(0, len(names) - 1, min(len(names), MAX_LEFT_OUT)).round()
    return [names[int(i)] for i in np.unique(chosen)]


def _fit(danced: DancedTasks) -> TaskModel:
    return fit_task_model(danced.poses, danced.persons, danced.tasks)


@dataclass(frozen=True, slots=True)
class _Factor:
    """One factor of a task model, the persons or the tasks.

    what: "person" or "task"; names: the labels; label: (c,) the label index of each cell of the
    model; weights: (13,) of the joints.
    """

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
        """(n,) the true labels as indices into `names`. Raises ValueError for an unknown label."""
        return np.array([self.names.index(name) for name in self.labels_of(danced)], np.int64)


def _tasks(model: TaskModel) -> _Factor:
    return _Factor("task", model.tasks, model.task, model.weights)


def _persons(model: TaskModel) -> _Factor:
    return _Factor("person", model.persons, model.person, model.weights)


@dataclass(frozen=True, slots=True)
class _Trained:
    """A model of one cycle, and its distances to a second cycle of the same dances.

    again: n segments of the second cycle; distances: (n, c, 13) their joint distances.
    """

    model: TaskModel
    again: DancedTasks
    distances: FloatArray

    @classmethod
    def fit(cls, first: DancedTasks, again: DancedTasks) -> _Trained:
        model = _fit(first)
        return cls(model, again, model.joint_distances(again.poses))

    def row_of_table_4(
        self, what: str, new: DancedTasks, known: DancedTasks, reading: Reading
    ) -> Row:
        """A row of Table 4: segments of new labels, and segments of known labels."""
        factor, paper = (
            (_tasks(self.model), 0.9166) if what == "task" else (_persons(self.model), 0.8333)
        )
        accepted = [
            self._within(factor, part, NEW_THRESHOLD, reading)[0].any(axis=1)
            for part in (new, known)
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

    def row_of_table_5(self, category: str, probes: DancedTasks, reading: Reading) -> Row:
        """A row of Table 5: a segment counts if the nearest task within thresholds is right."""
        factor = _tasks(self.model)
        within, objectives = self._within(factor, probes, NAMED_THRESHOLD, reading)
        best = np.where(within, objectives, np.inf).argmin(axis=1)
        right = [
            within[row].any() and factor.names[label] == truth
            for row, (label, truth) in enumerate(zip(best.tolist(), probes.tasks, strict=True))
        ]
        paper = 0.8333 if "alien" in category else 0.9166
        return Row(5, category, reading, len(probes), int(np.sum(right)), paper)

    def _within(
        self, factor: _Factor, probes: DancedTasks, threshold: float, reading: Reading
    ) -> tuple[BoolArray, FloatArray]:
        """(n, names) whether F*_Pr is within thresholds of F*_k, and (n, names) the objectives
        of eq. 16; the smallest is the best."""
        low, high = self._trained(factor, reading, of_others=threshold == NAMED_THRESHOLD)
        signed = factor.objective(self.model.joint_distances(probes.poses), reading)
        value = np.abs(signed)
        within = value * (1 - threshold) <= high * (1 + threshold)
        if reading is Reading.PRINTED:
            within &= value * (1 + threshold) >= low * (1 - threshold)
        return within, signed

    def _trained(
        self, factor: _Factor, reading: Reading, *, of_others: bool
    ) -> tuple[FloatArray, FloatArray]:
        """The smallest and the largest accepted F*_k (eq. 15) for each of `names`.

        of_others: F*_k is computed between different persons who did the same task, not between
        cycles of one person, since the task of an alien person cannot be nearer.
        """
        distances, own = self.distances, factor.index(self.again)
        if of_others and reading is Reading.LEAST:
            same_person = _persons(self.model).index(self.again)[:, None] == self.model.person
            distances = np.where(same_person[..., None], np.inf, distances)
        own_values = np.abs(factor.objective(distances, reading))[np.arange(len(own)), own]
        # a task without another dancer has an infinite distance
        usable = np.isfinite(own_values)
        values = [own_values[(own == k) & usable] for k in range(len(factor.names))]
        if reading is Reading.LEAST and not of_others:
            values = [each.mean(keepdims=True) if len(each) else each for each in values]
        low = np.array([each.min(initial=np.inf) for each in values])
        return low, np.array([each.max(initial=0.0) for each in values])
