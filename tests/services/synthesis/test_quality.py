"""The held-out figures that are reported for a motion."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from app.services.synthesis.plan import Plan, SynthesisKind
from app.services.synthesis.quality import expected_of

FIGURES: dict[str, Any] = {
    "held_out": {
        "new_task": [{"given": 1, "real": 0.9}, {"given": 3, "real": 0.8}],
        "new_person": [{"given": 2, "real": None}],
    },
    "expected_hits": {
        "new_task": {"weights": [-1.0, 1.0, -2.0, 0.5], "most": 5, "trials": 90},
        "new_person": {"weights": [0.0, 0.0, 0.0, 0.0], "most": 2, "trials": 7},
    },
}


def plan(kind: SynthesisKind, given: int, follows: str | None = None) -> Plan:
    names = tuple(f"n{i}" for i in range(given))
    return Plan(kind, "x", "t", np.zeros(1378), (), names, names, (), follows, 0.5)


@pytest.mark.parametrize(
    ("given", "follows", "shows_task", "logit", "of", "real"),
    [
        (1, None, False, -1.0, 1, 0.9),
        (2, None, True, -0.5 + np.log(2), 2, 0.9),
        (3, "n0", True, -2.5 + np.log(3), 3, 0.8),
        (30, None, False, -1.0 + np.log(5), 5, 0.8),  # more than were tried
    ],
)
def test_the_expected_hit_depends_on_what_is_known(
    given: int, follows: str | None, shows_task: bool, logit: float, of: int, real: float
) -> None:
    asked = plan(SynthesisKind.NEW_TASK, given, follows)
    found = expected_of(FIGURES, asked, shows_task=shows_task)
    assert found is not None
    assert found.hit == pytest.approx(1 / (1 + np.exp(-logit)))
    assert (found.given, found.trials, found.real) == (of, 90, real)


def test_fewer_than_were_tried_have_the_upper_limit_of_the_fewest() -> None:
    found = expected_of(FIGURES, plan(SynthesisKind.NEW_PERSON, 1), shows_task=True)
    assert found is not None
    assert (found.hit, found.given, found.real) == (0.5, 1, None)


def test_a_recorded_task_has_no_expected_hit() -> None:
    assert expected_of(FIGURES, plan(SynthesisKind.SEEN, 1), shows_task=True) is None
    assert expected_of({}, plan(SynthesisKind.NEW_TASK, 1), shows_task=True) is None
