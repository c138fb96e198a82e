from __future__ import annotations

import numpy as np
import pytest
import scipy
from hypothesis import given
from hypothesis import strategies as st

from app.motion.skeleton.smoothing import CUT_OFFS, cut_off_of, low_passed, residuals
from app.numerics.arrays import FloatArray
from tests.bodies import walking

RATES = (30.0, 60.0, 120.0)


def noisy(positions: FloatArray, millimeters: float, seed: int = 0) -> FloatArray:
    rng = np.random.default_rng(seed)
    return positions + rng.normal(0.0, millimeters / 1000, positions.shape)


def filtered_residual(positions: FloatArray, rate: float, cut_off: float) -> float:
    """The obvious twin: filter, and measure what is gone, away from the ends."""
    single = cut_off / (np.sqrt(2.0) - 1.0) ** 0.25
    b, a = scipy.signal.butter(2, single / (rate / 2))
    removed = positions - scipy.signal.filtfilt(b, a, positions, axis=0)
    inside = removed[len(removed) // 10 : -len(removed) // 10]
    return float(np.sqrt(np.square(inside).mean()))


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("cut_off", [4.0, 6.0, 9.0])
def test_residuals_are_those_of_the_filter(rate: float, cut_off: float) -> None:
    positions = noisy(walking(20.0, rate), 5.0)
    found = residuals(positions, rate, np.array([cut_off]))[0]
    assert found == pytest.approx(filtered_residual(positions, rate, cut_off), rel=0.05)


@pytest.mark.parametrize("rate", RATES)
def test_more_noise_never_raises_the_cut_off(rate: float) -> None:
    cut_offs = [cut_off_of(noisy(walking(8.0, rate), noise), rate) for noise in (0, 2, 5, 10, 20)]
    assert all(np.diff(cut_offs) <= 0.5)
    assert cut_offs[-1] < CUT_OFFS[1]


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("millimeters", [3.0, 10.0])
def test_velocities_come_nearer_to_the_true_ones(rate: float, millimeters: float) -> None:
    true = walking(8.0, rate)
    measured = noisy(true, millimeters)
    smooth = low_passed(measured, rate, cut_off_of(measured, rate))
    before, after = (np.square(np.diff(each - true, axis=0)).mean() for each in (measured, smooth))
    assert after < before / 4


@pytest.mark.parametrize("cut_off", [4.0, 6.0])
def test_the_filter_halves_the_power_at_its_cut_off_and_delays_nothing(cut_off: float) -> None:
    rate, time = 120.0, np.arange(1200) / 120
    for hz, gain in ((1.0, 1.0), (cut_off, np.sqrt(0.5)), (20.0, 0.0)):
        wave = np.sin(2 * np.pi * hz * time)
        found = low_passed(wave, rate, cut_off)[200:-200]
        np.testing.assert_allclose(found, gain * wave[200:-200], atol=0.02)


@pytest.mark.parametrize("frames", [1, 2, 3, 10])
@pytest.mark.parametrize("rate", [10.0, 30.0, 240.0])
def test_short_and_slow_clips_pass(frames: int, rate: float) -> None:
    steady = np.linspace(0, 1, frames)[:, None] * np.ones(3)
    np.testing.assert_allclose(low_passed(steady, rate, 6.0), steady, atol=0.01)


@given(
    frames=st.integers(1, 60),
    rate=st.sampled_from([1.0, 7.5, 12.0, 30.0, 2000.0]),
    place=st.floats(-1e3, 1e3),
)
def test_any_length_and_rate_gives_finite_numbers(frames: int, rate: float, place: float) -> None:
    positions = np.random.default_rng(frames).normal(place, 1.0, (frames, 2, 3))
    cut_off = cut_off_of(positions, rate)
    assert CUT_OFFS[0] <= cut_off <= CUT_OFFS[1]
    smooth = low_passed(positions, rate, cut_off)
    assert smooth.shape == positions.shape
    assert np.isfinite(smooth).all()


def test_a_steady_movement_and_a_rest_do_not_change() -> None:
    steps = np.arange(90.0)[:, None, None] * np.ones((1, 13, 3))
    for positions in (steps, np.ones_like(steps)):
        np.testing.assert_allclose(low_passed(positions, 30.0, 5.0), positions, atol=1e-6)
        assert np.isfinite(cut_off_of(positions, 30.0))
