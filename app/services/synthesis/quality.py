"""The quality of a synthesized motion: its nearest real clip, and the expected error rates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.held_out.expected_hits import ExpectedHits
from app.models.synthesis.model import Synthesis
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.services.library.fitted_models import Fitted
from app.services.library.library import Library
from app.services.synthesis.movement import Doubt, doubts, movement_of, real_movement
from app.services.synthesis.plan import Plan, SynthesisKind
from app.services.training.synthesis_fit import EXPECTED_HITS
from app.store import models
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord


@dataclass(frozen=True, slots=True)
class Quality:
    """kind, given_persons, given_tasks: see Plan.

    nearest: the real clip that is most like the synthesized motion, which is analyzed like any
    clip; None if it was removed; nearest_person, nearest_task: its labels; distance: to it;
    person_is_right, task_is_right: whether its labels are those of the query.
    follows, agreement: see Plan.
    expected_hit: the expected chance that the nearest real clip of the same person at the task, if
    it existed, were the nearest of all (see `ExpectedHits`); expected_given: the number of persons
    (or tasks) that it is for, at most the largest that was tried; expected_trials: the number of
    held-out motions that it was learned from; real_hit: the hits of the real takes of such cells,
    an upper limit. All are None for a recorded cell, or if no cell could be left out.
    skate, jerk: see `Movement`; real_skate, real_jerk: the means of real takes of the task;
    doubts: if the motion is much worse than those.
    """

    kind: SynthesisKind
    given_persons: tuple[str, ...]
    given_tasks: tuple[str, ...]
    follows: str | None
    agreement: float | None
    nearest: ClipRecord | None
    nearest_person: str
    nearest_task: str
    distance: float
    person_is_right: bool | None
    task_is_right: bool
    expected_hit: float | None
    expected_given: int | None
    expected_trials: int | None
    real_hit: float | None
    skate: float
    real_skate: float | None
    jerk: float
    real_jerk: float | None
    doubts: tuple[Doubt, ...]


def judge(
    lib: Library, fitted: Fitted[Synthesis], plan: Plan, motion: Motion, shape: FloatArray
) -> Quality:
    """The quality of a synthesized motion; shape: (1378,) from its analysis."""
    model = fitted.model
    distances = model.distances(shape)
    first = int(np.argmin(distances))
    person, task = model.labels_of(first)
    with lib.store.read() as tx:
        record = models.get(tx, fitted.id)
        nearest = clips.get_many(tx, [model.ids[first]]).get(model.ids[first])
    expected = expected_of(
        record.meta.get("figures", {}), plan, shows_task=_shows_task(model, plan, distances)
    )
    own = movement_of(motion)
    real = real_movement(lib, [model.ids[i] for i in model.clips_of(task=plan.task)])
    return Quality(
        kind=plan.kind,
        given_persons=plan.given_persons,
        given_tasks=plan.given_tasks,
        follows=plan.follows,
        agreement=plan.agreement,
        nearest=nearest,
        nearest_person=person,
        nearest_task=task,
        distance=float(distances[first]),
        person_is_right=None if plan.person is None else person == plan.person,
        task_is_right=task == plan.task,
        expected_hit=None if expected is None else expected.hit,
        expected_given=None if expected is None else expected.given,
        expected_trials=None if expected is None else expected.trials,
        real_hit=None if expected is None else expected.real,
        skate=own.skate,
        real_skate=None if real is None else real.skate,
        jerk=own.jerk,
        real_jerk=None if real is None else real.jerk,
        doubts=doubts(own, real, plan.task),
    )


@dataclass(frozen=True, slots=True)
class Expected:
    """The expected hit of a motion; see `Quality`."""

    hit: float
    given: int
    trials: int
    real: float | None


def expected_of(figures: dict[str, Any], plan: Plan, *, shows_task: bool) -> Expected | None:
    """What the held-out figures say about a motion like this one; None for a recorded cell.

    shows_task: whether the real clip nearest to the motion, without those of its cell, shows the
    task. None too if no cell could be held out.
    """
    curve = figures.get(EXPECTED_HITS, {}).get(plan.kind.value)
    if curve is None:
        return None
    is_new_task = plan.kind is SynthesisKind.NEW_TASK
    hits = ExpectedHits.from_json(curve)
    given = min(len(plan.given_persons if is_new_task else plan.given_tasks), hits.most)
    hit = hits.of(given, follows=plan.follows is not None, shows_task=shows_task)
    rows = figures["held_out"][plan.kind.value]
    fewer = [row for row in rows if row["given"] <= given]
    return Expected(hit, given, hits.trials, (fewer[-1] if fewer else rows[0])["real"])


def _shows_task(model: Synthesis, plan: Plan, distances: FloatArray) -> bool:
    """Whether the real clip with the least distance, without those of the cell, shows the task."""
    others = np.array(distances)
    if plan.person is not None:
        others[model.clips_of(plan.person, plan.task)] = np.inf
    return model.labels_of(int(np.argmin(others)))[1] == plan.task
