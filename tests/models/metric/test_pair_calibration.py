from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from sklearn.linear_model import LogisticRegression

from app.models.metric.pair_calibration import LEVELS, SLOPES, PairCalibration, calibrate_pairs


def pairs(level: float, slope: float, count: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    distances = rng.uniform(0, 2, count)
    return distances, rng.uniform(size=count) < 1 / (1 + np.exp(slope * distances - level))


@pytest.mark.parametrize(("level", "slope"), [(2.0, 4.0), (6.0, 9.0), (-1.0, 1.0)])
def test_the_curve_that_generated_the_pairs_is_fitted(level: float, slope: float) -> None:
    distances, same = pairs(level, slope, 40_000)
    found = calibrate_pairs(distances, same)
    twin = LogisticRegression(C=1e9).fit(distances[:, None], same)
    assert found.level == pytest.approx(twin.intercept_[0], abs=0.1)
    assert found.slope == pytest.approx(-twin.coef_[0, 0], abs=0.1)
    told = found.probabilities(distances)
    for low in np.arange(0, 1, 0.2):
        chosen = (told >= low) & (told < low + 0.2)
        if chosen.sum() > 500:
            assert told[chosen].mean() == pytest.approx(same[chosen].mean(), abs=0.03)


def test_cleanly_separated_pairs_do_not_make_a_step() -> None:
    distances = np.array([0.1, 0.2, 0.3, 1.0, 1.1, 1.2])
    found = calibrate_pairs(distances, distances < 0.5)
    assert found.probability(0.1) > 0.6
    assert found.probability(1.2) < 0.4
    assert found.probability(0.0) < 0.99
    many = calibrate_pairs(np.tile(distances, 1000), np.tile(distances < 0.5, 1000))
    assert many.probability(0.3) > 0.99
    assert many.probability(1.0) < 0.01


@pytest.mark.parametrize("same", [[], [True, True], [False, False]])
def test_without_pairs_of_both_kinds_there_is_still_a_curve(same: list[bool]) -> None:
    found = calibrate_pairs(np.linspace(0, 1, len(same)), np.array(same, dtype=bool))
    assert found.probability(0) > 0.9
    assert found.probability(2) < 0.01


def test_scores_fall_with_distance_for_any_pairs() -> None:
    rng = np.random.default_rng(0)
    distances = rng.uniform(0, 2, 1000)
    for same in (distances > 1, rng.uniform(size=1000) < 0.5, distances < 1e-3):
        found = calibrate_pairs(distances, same)
        assert LEVELS[0] <= found.level <= LEVELS[1]
        assert SLOPES[0] <= found.slope <= SLOPES[1]


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("slope", SLOPES)
def test_different_distances_have_different_scores(level: float, slope: float) -> None:
    curve = PairCalibration(level, slope)
    distances = np.round(np.concatenate([np.arange(2000) * 1e-9, np.linspace(0, 2, 2000)]), 9)
    scores = [curve.probability(float(d)) for d in np.unique(distances)]
    assert all(one > other > 0 for one, other in pairwise(scores))
