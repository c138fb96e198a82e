from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import spearmanr

from app.numerics.hmm.divergence import (
    expected_path_divergences,
    monte_carlo_divergence,
    symmetric_divergences,
)
from app.numerics.hmm.fit import fit_left_to_right
from app.numerics.hmm.model import GaussianHMM, log_emissions
from tests.numerics.hmm_reference import wavy

FLOOR = np.full(6, 0.1)


@pytest.fixture(scope="module")
def models() -> list[GaussianHMM]:
    lengths = [1, 4, 20, 45, 60, 90, 120, 60, 75, 100]
    return [
        fit_left_to_right(wavy(frames, seed), states=12, variance_floor=FLOOR)
        for seed, frames in enumerate(lengths)
    ]


def naive_score(source: GaussianHMM, target: GaussianHMM) -> float:
    """The same recursion, one pair, one frame, double precision."""
    expected = np.array(
        [
            log_emissions(mean[None], target.means, target.variances)[0]
            - 0.5 * (variance / target.variances).sum(axis=1)
            for mean, variance in zip(source.means, source.variances, strict=True)
        ]
    )
    path = source.expected_path()
    alpha = np.full(target.states, -np.inf)
    alpha[0] = expected[path[0], 0]
    for state in path[1:]:
        stay = alpha + target.log_stay()
        move = np.append(-np.inf, alpha[:-1] + target.log_move())
        alpha = np.maximum(stay, move) + expected[state]
    return float(np.logaddexp.reduce(alpha)) / len(path)


def test_all_pairs_at_once_are_the_pairs_one_by_one(models: list[GaussianHMM]) -> None:
    expected = [[max(naive_score(s, s) - naive_score(s, t), 0.0) for t in models] for s in models]
    ours = expected_path_divergences(models, models)
    np.testing.assert_allclose(ours, expected, rtol=1e-4, atol=1e-4)


def test_ranks_as_monte_carlo_does(models: list[GaussianHMM]) -> None:
    slow = [[monte_carlo_divergence(s, t, draws=10) for t in models] for s in models]
    fast = expected_path_divergences(models, models)
    assert spearmanr(np.ravel(slow), fast.ravel()).statistic > 0.98


def test_a_symbol_has_divergence_zero_to_itself(models: list[GaussianHMM]) -> None:
    np.testing.assert_allclose(np.diag(symmetric_divergences(models, models)), 0.0, atol=1e-4)


def test_symmetric_for_equal_and_for_different_lists(models: list[GaussianHMM]) -> None:
    whole = symmetric_divergences(models, models)
    np.testing.assert_allclose(whole, whole.T)
    np.testing.assert_allclose(symmetric_divergences(models[:3], models), whole[:3], atol=1e-4)


def test_takes_of_one_motion_are_nearer_than_others() -> None:
    rng = np.random.default_rng(0)
    takes = [wavy(60, 1), wavy(60, 1) + rng.normal(size=(60, 6)) * 0.1, wavy(60, 2)]
    fits = [fit_left_to_right(take, states=10, variance_floor=FLOOR) for take in takes]
    distances = symmetric_divergences(fits, fits)
    assert distances[0, 1] < 0.1 * distances[0, 2]


def test_no_models_have_no_divergences(models: list[GaussianHMM]) -> None:
    assert expected_path_divergences([], models).shape == (0, len(models))
    assert expected_path_divergences(models, []).shape == (len(models), 0)
