from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.hmm import log_likelihood
from app.numerics.hmm_fit import fit_left_to_right
from tests.numerics.hmm_reference import as_hmmlearn, wavy

FLOOR = np.full(6, 0.1)


@pytest.mark.parametrize(("frames", "states"), [(90, 10), (300, 30), (45, 5)])
def test_agrees_with_hmmlearn(frames: int, states: int) -> None:
    sequence = wavy(frames, 5)
    start = fit_left_to_right(sequence, states=states, variance_floor=FLOOR, iterations=0)
    reference = as_hmmlearn(start, FLOOR, iterations=3)
    reference.fit(sequence)
    ours = fit_left_to_right(sequence, states=states, variance_floor=FLOOR, iterations=3)
    np.testing.assert_allclose(ours.means, reference.means_, atol=1e-5)
    np.testing.assert_allclose(ours.transitions, reference.transmat_, atol=1e-5)
    variances = np.array([np.diag(covariance) for covariance in reference.covars_])
    np.testing.assert_allclose(ours.variances, variances, atol=1e-5)


def test_learning_raises_the_likelihood() -> None:
    sequence = wavy(120, 6)
    fits = [
        fit_left_to_right(sequence, states=8, variance_floor=FLOOR, iterations=n) for n in (0, 1, 5)
    ]
    likelihoods = [log_likelihood(model, sequence) for model in fits]
    assert likelihoods[0] < likelihoods[1] < likelihoods[2]


@settings(max_examples=40, deadline=None)
@given(
    frames=st.integers(1, 120),
    channels=st.integers(1, 5),
    states=st.integers(1, 30),
    scale=st.sampled_from([0.0, 1e-9, 1.0, 1e4]),
    place=st.sampled_from([0.0, -1e5]),
    seed=st.integers(0, 5),
)
def test_never_fails(
    frames: int, channels: int, states: int, scale: float, place: float, seed: int
) -> None:
    sequence = wavy(frames, seed, channels) * scale + place
    floor = np.full(channels, 0.1)
    model = fit_left_to_right(sequence, states=states, variance_floor=floor)
    assert 1 <= model.states <= min(states, max(1, frames // 3))
    assert np.isfinite(model.means).all()
    assert (model.variances >= 0.1).all()
    np.testing.assert_allclose(model.transitions.sum(axis=1), 1.0)
    assert (np.diagonal(model.transitions) > 0).all()
    assert np.isfinite(log_likelihood(model, sequence))


def test_is_deterministic() -> None:
    one, again = (fit_left_to_right(wavy(70, 7), states=9, variance_floor=FLOOR) for _ in range(2))
    np.testing.assert_array_equal(one.means, again.means)
    np.testing.assert_array_equal(one.transitions, again.transitions)
