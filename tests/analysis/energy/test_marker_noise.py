"""The estimate of marker noise does not depend on the movement."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.analysis.energy.marker_noise import MIN_FRAMES, noise_of_speed, noise_power
from app.motion.frame.body_frame import body_track
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, walking
from tests.dances import dance

ALIKE = np.full(13, 1 / 13)


def noise_of(positions: FloatArray, rate: float) -> float:
    """Standard deviation on each coordinate, meters, at the analysis rate."""
    track = body_track(motion_of(positions, rate))
    return float(np.sqrt(noise_power(track.positions, ALIKE) / 3))


@pytest.mark.parametrize("rate", [30.0, 60.0, 120.0])
@pytest.mark.parametrize("noise", [0.002, 0.005, 0.01, 0.025])
def test_the_noise_of_a_dance_is_estimated(noise: float, rate: float) -> None:
    made = dance(3, 110, beats=30, noise=noise, rate=rate)
    # The low-pass before the resampling keeps the share of the noise that 30 Hz can carry.
    assert noise_of(made.positions, rate) == pytest.approx(noise * np.sqrt(30 / rate), rel=0.12)


def test_clean_motion_has_almost_no_noise() -> None:
    assert noise_of(dance(4, 140, noise=0.0).positions, 60.0) < 2e-4
    assert noise_of(walking(8.0), 30.0) < 2e-4


@given(st.floats(0.01, 100.0), st.integers(0, 1000))
def test_noise_scales_with_the_unit_and_ignores_steady_movement(unit: float, seed: int) -> None:
    shaking = np.random.default_rng(seed).normal(size=(80, 13, 3))
    sliding = shaking + np.arange(80)[:, None, None] * 0.3 + 7.0
    assert noise_power(sliding, ALIKE) == pytest.approx(noise_power(shaking, ALIKE))
    assert noise_power(unit * shaking, ALIKE) == pytest.approx(
        unit**2 * noise_power(shaking, ALIKE)
    )


def test_joints_of_weight_0_are_ignored() -> None:
    shaking = np.zeros((200, 13, 3))
    shaking[:, 4] = np.random.default_rng(0).normal(size=(200, 3))
    on_it, beside = np.eye(13)[4], np.eye(13)[5]
    assert noise_power(shaking, on_it) == pytest.approx(3.0, rel=0.35)
    assert noise_power(shaking, beside) == 0.0


def test_a_short_clip_has_no_noise() -> None:
    assert noise_power(np.random.default_rng(0).normal(size=(MIN_FRAMES - 1, 13, 3)), ALIKE) == 0


@pytest.mark.parametrize("spread", [1.0, 2.0, 3.0])
def test_noise_of_speed_agrees_with_simulated_noise(spread: float) -> None:
    rng = np.random.default_rng(1)
    reach = np.arange(-20, 21)
    kernel = np.exp(-0.5 * (reach / spread) ** 2)
    smooth = np.convolve(rng.normal(size=200_000), kernel / kernel.sum(), mode="valid")
    speeds = (smooth[2:] - smooth[:-2]) / 2
    assert noise_of_speed(spread) == pytest.approx(speeds.var(), rel=0.05)
