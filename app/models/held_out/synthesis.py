"""Held-out figures of synthesis: how often a synthesized motion is recognized as intended.

Vasilescu's test (section 7): a cell is left out and synthesized. It is a hit if the real clip that
is nearest to the synthesized motion has the same person and the same task.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.held_out.expected_hits import Outcome, fit_expected_hits, reliability
from app.models.synthesis.model import Synthesis
from app.models.synthesis.prediction import Predicted, predict
from app.models.synthesis.solving import effects_only
from app.numerics.arrays import FloatArray
from app.numerics.euclidean import distances

GIVEN_COUNTS = (1, 2, 3, 5, 8)
"""Numbers of other persons (or tasks) with takes that a prediction may use."""

TRIALS = 32
"""Largest number of cells that are left out for each row; of more cells, a random subset."""

TAKES_AT_ONCE = 64
"""Takes that are compared with all clips at once. It bounds the memory."""

NEW_TASK, NEW_PERSON = "new_task", "new_person"


@dataclass(frozen=True, slots=True)
class Trial:
    """A left-out cell, the person at the task; given: the other persons, or other tasks, to use."""

    person: str
    task: str
    given: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Judged:
    """The result of a trial: the outcome, whether the person and the task of the nearest real clip
    are right, and whether the baselines "effects" and "task_mean" hit."""

    trial: Trial
    outcome: Outcome
    is_person: bool
    is_task: bool
    effects: bool
    task_mean: bool


def judge_trials(record: Synthesis, trials: int = TRIALS) -> dict[str, list[Judged]]:
    """The results of at most `trials` trials for each number in GIVEN_COUNTS, by kind."""
    return {
        kind: [
            _judged(record, kind, trial)
            for given in GIVEN_COUNTS
            for trial in draw_trials(record, kind, given, trials)
        ]
        for kind in (NEW_TASK, NEW_PERSON)
    }


def held_out_synthesis(record: Synthesis, trials: int = TRIALS) -> dict[str, list[dict[str, Any]]]:
    """The rows (see `held_out_rows`) of `judge_trials`."""
    return held_out_rows(record, judge_trials(record, trials))


def expected_hits(judged: dict[str, list[Judged]]) -> dict[str, dict[str, Any]]:
    """By kind that has trials, the curve of `ExpectedHits` and its "reliability", as JSON."""
    found = {}
    for kind, results in judged.items():
        outcomes = [one.outcome for one in results]
        if outcomes:
            curve = fit_expected_hits(outcomes)
            found[kind] = {**curve.to_json(), "reliability": reliability(outcomes)}
    return found


def held_out_rows(
    record: Synthesis, judged: dict[str, list[Judged]]
) -> dict[str, list[dict[str, Any]]]:
    """Rows for "new_task" and "new_person", one for each number of given persons or tasks.

    "new_task": a task of a known person, from takes by `given` other persons. "new_person": a
    task of a new person, from takes of `given` of their tasks; all other persons are known.

    Each row has "given", "trials", and the shares of trials whose nearest real clip has the
    right "person", the right "task", and both ("hit"); the hits of the baselines "effects" (sum
    of person and task effects) and "task_mean"; "followed" and "averaged": trials and hit of
    those that follow one person's take, and of the others (hit is None without trials); "real":
    the hit of the cells' real takes among all other real clips, None if no cell has two takes.
    "real" is an upper limit of what synthesis can reach.
    """
    return {
        kind: [
            _row(record, given, of_given)
            for given in GIVEN_COUNTS
            if (of_given := [one for one in results if one.outcome.given == given])
        ]
        for kind, results in judged.items()
    }


def nearest_labels(record: Synthesis, shape: FloatArray) -> tuple[str, str]:
    """Person and task of the real clip nearest to a motion shape (1378,)."""
    return record.labels_of(int(np.argmin(record.distances(shape))))


def synthesized(record: Synthesis, kind: str, trial: Trial) -> Predicted:
    """The synthesized cell of a trial."""
    own = record.tasks_of(trial.person)
    if kind == NEW_PERSON:
        own = {task: own[task] for task in trial.given}
        return predict(record, own, trial.task, exclude=(trial.person,))
    strangers = set(record.persons) - set(trial.given)
    return predict(record, own, trial.task, exclude=tuple(strangers))


def draw_trials(record: Synthesis, kind: str, given: int, trials: int) -> list[Trial]:
    """At most `trials` cells that have `given` others to use; deterministic."""
    rng = np.random.default_rng(given)
    possible = []
    for person, task in zip(record.person, record.task, strict=True):
        who, what = record.persons[person], record.tasks[task]
        pool = _others(record, who, what, kind)
        if len(pool) >= given:
            chosen = rng.choice(len(pool), given, replace=False)
            possible.append(Trial(who, what, tuple(pool[i] for i in sorted(chosen))))
    if len(possible) <= trials:
        return possible
    return [possible[i] for i in np.sort(rng.choice(len(possible), trials, replace=False))]


def _others(record: Synthesis, person: str, task: str, kind: str) -> list[str]:
    if kind == NEW_TASK:
        own = set(record.tasks_of(person)) - {task}
        return [name for name in record.who_did(task) if name != person] if own else []
    if record.who_did(task) == (person,):
        return []
    return [name for name in record.tasks_of(person) if name != task]


def _row(record: Synthesis, given: int, judged: Sequence[Judged]) -> dict[str, Any]:
    marks = np.array(
        [
            (one.is_person, one.is_task, one.outcome.is_hit, one.effects, one.task_mean)
            for one in judged
        ],
        dtype=np.float64,
    )
    names = ("person", "task", "hit", "effects", "task_mean")
    shares = {
        name: round(float(hit), 4) for name, hit in zip(names, marks.mean(axis=0), strict=True)
    }
    followed = np.array([one.outcome.follows for one in judged])
    by_way = {"followed": _hit(marks[followed, 2]), "averaged": _hit(marks[~followed, 2])}
    real = real_hit(record, [one.trial for one in judged])
    return {"given": given, "trials": len(judged), **shares, **by_way, "real": real}


def _hit(hits: FloatArray) -> dict[str, Any]:
    share = round(float(hits.mean()), 4) if len(hits) else None
    return {"trials": len(hits), "hit": share}


def real_hit(record: Synthesis, drawn: list[Trial]) -> float | None:
    """Share of the real takes of the trials' cells whose nearest other clip is of the same cell."""
    hits = []
    for trial in drawn:
        takes = record.clips_of(trial.person, trial.task)
        for first in range(0, len(takes) if len(takes) > 1 else 0, TAKES_AT_ONCE):
            some = takes[first : first + TAKES_AT_ONCE]
            away = distances(record.points[some], record.points)
            away[np.arange(len(some)), some] = np.inf  # not the take itself
            nearest = away.argmin(axis=1)
            hits += [record.labels_of(int(one)) == (trial.person, trial.task) for one in nearest]
    return round(float(np.mean(hits)), 4) if hits else None


def _judged(record: Synthesis, kind: str, trial: Trial) -> Judged:
    label = (trial.person, trial.task)
    predicted = synthesized(record, kind, trial)
    away = record.distances(predicted.shape)
    found = record.labels_of(int(np.argmin(away)))
    away[record.clips_of(*label)] = np.inf
    shown = record.labels_of(int(np.argmin(away)))[1]
    baselines = [
        nearest_labels(record, baseline(record, kind, trial, by)) == label
        for by in (effects_only, task_mean)
    ]
    follows = predicted.follows is not None
    outcome = Outcome(trial.person, len(trial.given), follows, shown == trial.task, found == label)
    return Judged(trial, outcome, found[0] == trial.person, found[1] == trial.task, *baselines)


Baseline = Callable[[FloatArray, FloatArray, FloatArray], FloatArray]
"""Predicts a shape (1378,) from basis, target and own shapes, as `effects_only` does."""


def baseline(record: Synthesis, kind: str, trial: Trial, by: Baseline) -> FloatArray:
    """(1378,) the cell of a trial by the baseline `by`, which uses only recorded cells."""
    own = record.tasks_of(trial.person)
    own.pop(trial.task)
    if kind == NEW_PERSON:
        own = {task: own[task] for task in trial.given}
    others = trial.given if kind == NEW_TASK else record.who_did(trial.task)
    cells = {name: record.tasks_of(name) for name in others if name != trial.person}
    shared = [task for task in own if all(task in did for did in cells.values())]
    target = np.stack([did[trial.task] for did in cells.values()])
    if not shared:
        return task_mean(target, target, target)
    basis = np.stack([[did[task] for task in shared] for did in cells.values()])
    return by(basis, target, np.stack([own[task] for task in shared]))


def task_mean(_: FloatArray, target: FloatArray, __: FloatArray) -> FloatArray:
    """(1378,) the mean of the target task by K others, `target` (K, 1378): a baseline."""
    return np.asarray(target.mean(axis=0))
