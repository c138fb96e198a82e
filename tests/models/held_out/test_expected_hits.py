from __future__ import annotations

import json

import numpy as np
import pytest

from app.models.held_out.expected_hits import (
    ExpectedHits,
    Outcome,
    fit_expected_hits,
    reliability,
)


def drawn(count: int, seed: int = 0, slope: float = 1.0) -> list[Outcome]:
    """Outcomes whose chance of a hit is known: it rises with `given`, and falls for followers."""
    rng = np.random.default_rng(seed)
    found = []
    for number in range(count):
        given = int(rng.choice([1, 2, 3, 5, 8]))
        follows, shows = bool(rng.random() < 0.2), bool(rng.random() < 0.7)
        logit = -1.5 + slope * np.log(given) - 2.0 * follows + 1.0 * shows
        hit = bool(rng.random() < 1 / (1 + np.exp(-logit)))
        found.append(Outcome(f"p{number % 7}", given, follows, shows, hit))
    return found


def test_it_learns_the_chances_that_the_outcomes_have() -> None:
    curve = fit_expected_hits(drawn(20_000, seed=2))
    np.testing.assert_allclose(curve.weights, (-1.5, 1.0, -2.0, 1.0), atol=0.15)
    assert (curve.most, curve.trials) == (8, 20_000)
    assert curve.of(50, follows=False, shows_task=True) == curve.of(
        8, follows=False, shows_task=True
    )


def test_what_is_said_after_a_usual_fit_is_seen_later() -> None:
    curves = [fit_expected_hits(drawn(160, seed=seed)) for seed in range(20)]
    later = drawn(4000, seed=100)
    for given in (1, 3, 8):
        own = [one for one in later if one.given == given]
        said = [
            curve.of(given, follows=one.follows, shows_task=one.shows_task)
            for curve in curves
            for one in own[:100]
        ]
        assert np.mean(said) == pytest.approx(np.mean([one.is_hit for one in own]), abs=0.06)


def test_more_takes_never_lower_the_expectation() -> None:
    for seed in range(5):
        curve = fit_expected_hits(drawn(40, seed=seed, slope=-0.5))
        said = [curve.of(given, follows=False, shows_task=True) for given in range(1, 9)]
        assert said == sorted(said)


@pytest.mark.parametrize("is_hit", [True, False])
def test_a_single_outcome_gives_no_certainty(is_hit: bool) -> None:
    curve = fit_expected_hits([Outcome("p", 1, False, True, is_hit)])
    assert 0.001 < curve.of(1, follows=False, shows_task=True) < 0.999


def test_reliability_is_of_persons_that_were_not_learned() -> None:
    rows = reliability(drawn(700, seed=3))
    assert sum(row["trials"] for row in rows) == 700
    said = [row["said"] for row in rows]
    assert said == sorted(said)
    for row in rows:
        assert row["said"] == pytest.approx(row["seen"], abs=0.12)
    # A person who always hits says nothing about a person who never does.
    apart = [Outcome("a", 1, False, True, True)] * 20 + [Outcome("b", 1, False, True, False)] * 20
    first, *_, last = reliability(apart)
    assert (first["said"] < 0.1, first["seen"]) == (True, 1.0)
    assert (last["said"] > 0.9, last["seen"]) == (True, 0.0)
    assert reliability(apart[:5]) == []


def test_a_curve_comes_back_from_json() -> None:
    curve = fit_expected_hits(drawn(30))
    assert ExpectedHits.from_json(json.loads(json.dumps(curve.to_json()))) == curve
