from __future__ import annotations

import numpy as np
import pytest
from hmmlearn import hmm as learning

from app.numerics.hmm import model as hmm
from app.numerics.hmm.fit import fit_left_to_right
from app.numerics.hmm.model import (
    GaussianHMM,
    forward,
    log_emissions,
    log_likelihood,
    log_likelihoods,
    mean_trajectory,
)
from tests.numerics.hmm_reference import naive_forward, wavy

FLOOR = np.full(6, 0.1)


@pytest.fixture
def model() -> GaussianHMM:
    return fit_left_to_right(wavy(80, 1), states=12, variance_floor=FLOOR)


def test_forward_is_the_recursion_over_frames(model: GaussianHMM) -> None:
    emissions = log_emissions(wavy(60, 2), model.means, model.variances)
    ours = forward(emissions, model.log_stay(), model.log_move())
    np.testing.assert_allclose(
        ours, naive_forward(emissions, model.transitions), rtol=1e-9, atol=1e-6
    )


@pytest.mark.parametrize("frames", [1, 5, 60, 400])
def test_likelihood_is_hmmlearns(model: GaussianHMM, frames: int) -> None:
    sequence = wavy(frames, 4)
    reference = learning.GaussianHMM(model.states, covariance_type="diag")
    reference.startprob_ = np.eye(model.states)[0]
    reference.transmat_, reference.means_ = model.transitions, model.means
    reference.covars_ = model.variances
    expected = reference.score(sequence)
    assert log_likelihood(model, sequence) == pytest.approx(expected, rel=1e-6)


def test_the_short_start_of_a_motion_is_possible_for_a_long_model(model: GaussianHMM) -> None:
    assert np.isfinite(log_likelihood(model, wavy(80, 1)[:2]))


def test_the_symbol_most_likely_to_generate_a_motion_is_its_own() -> None:
    models = [fit_left_to_right(wavy(60, s), states=10, variance_floor=FLOOR) for s in range(5)]
    for seed in range(5):
        assert np.argmax(log_likelihoods(models, wavy(60, seed))) == seed


def test_many_models_are_scored_as_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    models = [
        fit_left_to_right(wavy(60, seed), states=states, variance_floor=FLOOR)
        for seed, states in enumerate((1, 5, 8, 3))
    ]
    motion = wavy(50, 3)
    one_by_one = [log_likelihood(model, motion) for model in models]
    np.testing.assert_allclose(log_likelihoods(models, motion), one_by_one, rtol=1e-10)
    monkeypatch.setattr(hmm, "MAX_EMISSIONS", 900)  # two models at once
    np.testing.assert_allclose(log_likelihoods(models, motion), one_by_one, rtol=1e-10)
    assert log_likelihoods([], motion).shape == (0,)


def test_expected_path_lasts_about_as_long_as_the_clip(model: GaussianHMM) -> None:
    path = model.expected_path()
    assert 60 <= len(path) <= 100
    assert set(path) == set(range(model.states))
    assert (np.diff(path) >= 0).all()


def test_mean_trajectory_is_near_the_motion(model: GaussianHMM) -> None:
    expected, got = wavy(80, 1), mean_trajectory(model)
    resampled = got[np.linspace(0, len(got) - 1, len(expected)).round().astype(int)]
    assert np.abs(resampled - expected).mean() < 0.4 * np.abs(expected - expected.mean(0)).mean()
