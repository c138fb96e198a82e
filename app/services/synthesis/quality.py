"""The quality of a synthesized motion: its nearest real clip, and the expected error rates."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from app.models.synthesis.model import Synthesis
from app.motion.frame.foot_contact import FEET, skating
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.services.library.fitted_models import Fitted
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.synthesis.plan import Plan, SynthesisKind
from app.store import models
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord, ClipState

MAX_TAKES = 5
"""Largest number of real takes whose foot skate is measured."""


@dataclass(frozen=True, slots=True)
class Quality:
    """kind, given_persons, given_tasks: see Plan.

    nearest: the real clip that is most like the synthesized motion, which is analyzed like any
    clip; None if it was removed; nearest_person, nearest_task: its labels; distance: to it;
    person_is_right, task_is_right: whether its labels are those of the query.
    follows, agreement: see Plan.
    expected_hit: share of the cells that were left out of the fit, and synthesized from as many
    persons (or tasks), whose nearest real clip had both labels right; it counts those that
    followed one take if this motion does, else the others; expected_given, expected_trials: the
    numbers of persons (or tasks) and of cells of that share; real_hit: the same share for the
    cells' real takes, an upper limit. All are None for a recorded cell, or if no cell could be
    left out.
    skate, real_skate: mean horizontal speed of feet that are low, m/s, of this motion and of
    real takes of the task.
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
        takes = list(clips.get_many(tx, list(plan.takes)).values())
    expected = expected_of(record.meta.get("figures", {}), plan)
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
        expected_hit=expected.get("hit"),
        expected_given=expected.get("given"),
        expected_trials=expected.get("trials"),
        real_hit=expected.get("real"),
        skate=_skate(motion),
        real_skate=_real_skate(lib, takes),
    )


def expected_of(figures: dict[str, Any], plan: Plan) -> dict[str, Any]:
    """The held-out hits of motions like this one.

    They are of motions that followed one take if the plan does, else of the others. The row is
    the one with as many given persons (or tasks), or else the nearest smaller, or else the
    nearest larger number that has such motions. Without any, the hits are of all motions.
    """
    rows = figures.get("held_out", {}).get(plan.kind.value, [])
    group = "averaged" if plan.follows is None else "followed"
    group_rows = [{**row, **row[group]} for row in rows if row[group]["trials"]]
    is_new_task = plan.kind is SynthesisKind.NEW_TASK
    given = len(plan.given_persons if is_new_task else plan.given_tasks)
    rows = group_rows or rows
    fewer = [row for row in rows if row["given"] <= given]
    return dict(fewer[-1]) if fewer else dict(rows[0]) if rows else {}


def _skate(motion: Motion) -> float:
    return skating(motion.role_positions()[:, FEET].astype(np.float64), motion.frame_rate)


def _real_skate(lib: Library, takes: list[ClipRecord]) -> float | None:
    ready = [clip for clip in takes if clip.state is ClipState.READY][:MAX_TAKES]
    found = [_skate(load_motion(lib, clip)) for clip in ready]
    return float(np.mean(found)) if found else None
