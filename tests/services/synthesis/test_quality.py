"""The held-out figures that are reported for a motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.services.synthesis.plan import Plan, SynthesisKind
from app.services.synthesis.quality import expected_of


def row(given: int, followed: tuple[int, float | None], averaged: tuple[int, float | None]) -> Any:
    of_all = sum(trials * (hit or 0.0) for trials, hit in (followed, averaged))
    trials = followed[0] + averaged[0]
    parts = {
        name: {"trials": part[0], "hit": part[1]}
        for name, part in (("followed", followed), ("averaged", averaged))
    }
    return {"given": given, "trials": trials, "hit": of_all / trials, "real": 0.9} | parts


FIGURES: dict[str, Any] = {
    "held_out": {
        "new_task": [
            row(1, (0, None), (10, 0.5)),
            row(2, (4, 0.25), (6, 0.7)),
            row(5, (2, 0.0), (8, 0.8)),
            row(8, (0, None), (3, 1.0)),
        ],
        "new_person": [row(1, (0, None), (5, 0.2)), row(3, (0, None), (5, 0.6))],
    }
}


def plan(kind: SynthesisKind, given: int, follows: str | None) -> Plan:
    names = tuple(f"n{i}" for i in range(given))
    return Plan(kind, "x", "t", np.zeros(1378), (), names, names, (), follows, 0.5)


@pytest.mark.parametrize(
    ("given", "follows", "hit", "of", "trials"),
    [
        (1, None, 0.5, 1, 10),
        (4, None, 0.7, 2, 6),
        (30, None, 1.0, 8, 3),
        (30, "n0", 0.0, 5, 2),  # the row of 8 has none that followed
        (3, "n0", 0.25, 2, 4),
        (1, "n0", 0.25, 2, 4),  # nor has that of 1: of more is the nearest that is known
    ],
)
def test_the_expected_hit_is_that_of_motions_of_the_same_kind(
    given: int, follows: str | None, hit: float, of: int, trials: int
) -> None:
    expected = expected_of(FIGURES, plan(SynthesisKind.NEW_TASK, given, follows))
    names = ("hit", "given", "trials", "real")
    assert [expected[name] for name in names] == [hit, of, trials, 0.9]


def test_without_motions_of_the_same_kind_the_expected_hit_is_that_of_all() -> None:
    expected = expected_of(FIGURES, plan(SynthesisKind.NEW_PERSON, 3, "n0"))
    assert (expected["hit"], expected["given"], expected["trials"]) == (0.6, 3, 5)


def test_a_recorded_task_has_no_expected_hit() -> None:
    assert expected_of(FIGURES, plan(SynthesisKind.SEEN, 1, None)) == {}
    assert expected_of({}, plan(SynthesisKind.NEW_TASK, 1, None)) == {}
