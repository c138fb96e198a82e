"""Curves go through their keys, rest at them, and do not overshoot."""

from __future__ import annotations

import numpy as np
import pytest

from app.demo.curves import ease, keyed_curve, periodic_curve, quintic_curve, softened, wobble

TIMES = np.arange(200) / 100.0


def test_ease_goes_from_rest_to_rest() -> None:
    course = ease(np.linspace(-0.5, 1.5, 2001))
    assert course[0] == 0.0
    assert course[-1] == 1.0
    assert np.all(np.diff(course) >= 0.0)
    assert ease(np.array([0.5]))[0] == pytest.approx(0.5)


def test_a_keyed_curve_goes_through_its_keys_and_stays_between_them() -> None:
    keys = [(0.2, 1.0), (0.5, 3.0), (0.9, 3.0), (1.5, -1.0)]
    curve = keyed_curve(TIMES, keys)
    for time, value in keys:
        assert curve[round(100 * time)] == pytest.approx(value)
    assert np.min(curve) == pytest.approx(-1.0)
    assert np.max(curve) == pytest.approx(3.0)
    assert np.all(curve[TIMES < 0.2] == 1.0)


def test_one_key_is_a_constant() -> None:
    assert np.all(keyed_curve(TIMES, [(1.0, 0.7)]) == 0.7)


def test_a_periodic_curve_is_closed() -> None:
    points = [(0.0, 0.0), (0.3, 1.0), (0.7, -0.5)]
    phase = np.linspace(0.0, 1.0, 11)
    np.testing.assert_allclose(
        periodic_curve(phase, points), periodic_curve(phase + 3.0, points), atol=1e-12
    )


def test_a_quintic_curve_goes_through_its_states() -> None:
    curve = quintic_curve(
        TIMES, [(0.0, 0.0, 0.0, 0.0), (1.0, 0.5, 2.0, -9.81), (1.9, 0.0, 0.0, 0.0)]
    )
    assert curve[100] == pytest.approx(0.5)
    assert np.gradient(curve, TIMES)[100] == pytest.approx(2.0, abs=0.01)


def test_wobble_is_small_and_repeatable() -> None:
    times = np.arange(6000) / 10.0
    one, two = (wobble(times, np.random.RandomState(3), 0.1) for _ in range(2))
    assert np.array_equal(one, two)
    assert np.std(one) == pytest.approx(0.1, rel=0.1)


def test_smoothing_does_not_change_a_constant() -> None:
    np.testing.assert_allclose(softened(np.full(200, 2.0), TIMES, 0.05), 2.0)
