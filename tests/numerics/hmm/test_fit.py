"""Fitted models: as the textbook has them, for any sequence, and quietly."""

from __future__ import annotations

import logging

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.hmm.fit import fit_left_to_right
from app.numerics.hmm.model import GaussianHMM, log_likelihood
from app.numerics.hmm.sampling import occupancy, sample
from tests.numerics.hmm_reference import naive_occupancy, textbook_em, wavy

FLOOR = np.full(6, 0.1)
FAR = 2.0**20
"""A factor that keeps every digit."""


def fitted(sequence: np.ndarray, states: int, **options: int) -> GaussianHMM:
    floor = np.full(sequence.shape[1], 0.1)
    return fit_left_to_right(sequence, states=states, variance_floor=floor, **options)


def assert_sound(model: GaussianHMM, sequence: np.ndarray) -> None:
    assert np.isfinite(model.means).all()
    assert np.isfinite(model.variances).all()
    assert (model.variances >= 0.1).all()
    np.testing.assert_allclose(model.transitions.sum(axis=1), 1.0)
    assert (np.diagonal(model.transitions) > 0).all()
    moves = model.transitions - np.diag(np.diagonal(model.transitions))
    np.testing.assert_array_equal(moves, np.diag(np.diagonal(moves, 1), 1))
    assert np.isfinite(log_likelihood(model, sequence))


@pytest.mark.parametrize(("frames", "states"), [(90, 10), (300, 30), (45, 5), (3, 1), (1, 1)])
def test_a_fit_is_that_of_the_textbook(frames: int, states: int) -> None:
    sequence = wavy(frames, 5)
    start = fitted(sequence, states, iterations=0)
    expected = textbook_em(start, sequence, FLOOR, 3)
    found = fitted(sequence, states, iterations=3)
    np.testing.assert_allclose(found.means, expected.means, atol=1e-9)
    np.testing.assert_allclose(found.transitions, expected.transitions, atol=1e-9)
    np.testing.assert_allclose(found.variances, expected.variances, atol=1e-9)


def test_a_frame_far_from_every_state_is_fitted() -> None:
    """Its probability is below the smallest number; logarithms take over."""
    sequence = np.random.default_rng(1).normal(size=(3000, 6))
    sequence[1000] = 1e5
    start = fitted(sequence, 4, iterations=0)
    expected = textbook_em(start, sequence, FLOOR, 2)
    found = fitted(sequence, 4, iterations=2)
    assert_sound(found, sequence)
    np.testing.assert_allclose(found.means, expected.means, rtol=1e-6)
    np.testing.assert_allclose(found.transitions, expected.transitions, atol=1e-6)


def test_learning_raises_the_likelihood() -> None:
    sequence = wavy(120, 6)
    likelihoods = [
        log_likelihood(fitted(sequence, 8, iterations=count), sequence) for count in (0, 1, 5)
    ]
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
    model = fitted(sequence, states)
    assert 1 <= model.states <= min(states, max(1, frames // 3))
    assert_sound(model, sequence)


def spiked(height: float) -> np.ndarray:
    sequence = wavy(400, 2)
    sequence[123] += height
    return sequence


HOSTILE = {
    "constant": np.full((50, 6), 3.25),
    "hardly moving": wavy(50, 1) * 1e-200,
    "one frame": wavy(1, 1),
    "two frames": wavy(2, 1),
    "three frames": wavy(3, 1),
    "frames that repeat": np.repeat(wavy(10, 1), 20, axis=0),
    "huge": wavy(90, 1) * 1e90,
    "one wild channel": wavy(90, 1) * [1e6, 0, 0, 0, 0, 0],
    "far away": wavy(90, 1) + FAR,
    "a jump": np.vstack([wavy(50, 1), wavy(50, 1) + 1e6]),
    "to and fro": np.tile(1e5 * (-1.0) ** np.arange(276)[:, None], 26),
    **{f"a spike of {height:g}": spiked(height) for height in (1e2, 1e4, 1e6, 1e8)},
}


@pytest.mark.parametrize("sequence", HOSTILE.values(), ids=HOSTILE)
def test_extreme_sequences_are_fitted_without_warnings(
    sequence: np.ndarray, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    one, again = fitted(sequence, 30), fitted(sequence, 30)
    assert_sound(one, sequence)
    np.testing.assert_array_equal(one.means, again.means)
    np.testing.assert_array_equal(one.variances, again.variances)
    np.testing.assert_array_equal(one.transitions, again.transitions)
    assert not caplog.records, "hmmlearn warns of short clips and falling likelihoods"


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, 1e150])
def test_nan_and_huge_numbers_are_refused(value: float) -> None:
    sequence = wavy(50, 1)
    sequence[20, 3] = value
    with pytest.raises(ValueError, match="expected channels within"):
        fitted(sequence, 10)


def test_a_shifted_sequence_has_the_same_model() -> None:
    near, far = fitted(wavy(90, 3), 10), fitted(wavy(90, 3) + FAR, 10)
    np.testing.assert_allclose(far.means - FAR, near.means, atol=1e-7)
    np.testing.assert_allclose(far.variances, near.variances, atol=1e-7)


def test_samples_repeat_with_their_seed_and_go_left_to_right() -> None:
    model = fitted(wavy(80, 1), 12)
    one, again = (sample(model, 50, np.random.RandomState(7)) for _ in range(2))
    np.testing.assert_array_equal(one, again)
    assert log_likelihood(model, one) > log_likelihood(model, one[::-1])


def test_samples_have_the_spread_and_the_length_of_the_states() -> None:
    model = GaussianHMM(
        np.array([[0.99, 0.01], [0.0, 1.0]]),
        np.array([[0.0, 50.0], [1000.0, -50.0]]),
        np.array([[1.0, 4.0], [9.0, 16.0]]),
    )
    rng = np.random.RandomState(0)
    drawn = [sample(model, 1500, rng) for _ in range(40)]
    first = [rows[rows[:, 0] < 500] for rows in drawn]
    assert np.mean([len(rows) for rows in first]) == pytest.approx(100, rel=0.4)
    assert all((rows[: len(head), 0] < 500).all() for rows, head in zip(drawn, first, strict=True))
    for rows, mean, variance in (
        (np.concatenate(first), model.means[0], model.variances[0]),
        (np.concatenate([r[r[:, 0] > 500] for r in drawn]), model.means[1], model.variances[1]),
    ):
        np.testing.assert_allclose(rows.mean(axis=0), mean, atol=0.3)
        np.testing.assert_allclose(rows.var(axis=0), variance, rtol=0.1)


@pytest.mark.parametrize("offset", [0.0, 30.0])
def test_occupancy_is_the_textbook_s_also_under_a_model_of_other_motion(offset: float) -> None:
    model, motion = fitted(wavy(80, 1), 12), wavy(60, 2) + offset
    found = occupancy(model, motion)
    np.testing.assert_allclose(found, naive_occupancy(model, motion), atol=1e-8)
    np.testing.assert_allclose(found.sum(axis=1), 1.0)
