"""Energy minima: one in each valley, in units of the median maximum."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.analysis.energy.energy import EnergyCurve
from app.analysis.keyposes.energy_minima import (
    MIN_MAXIMUM,
    EnergyMinimum,
    find_energy_minima,
    usual_length,
)
from app.numerics.arrays import FloatArray


def curve(values: FloatArray, noise: float = 0.0) -> EnergyCurve:
    return EnergyCurve(values, noise, 1 / 30)


def humps(heights: list[float], width: int = 20, hold: int = 6) -> FloatArray:
    """EnergyMinimum, hump, rest, hump, ..., rest; rests of `hold` frames at zero."""
    parts = [np.zeros(hold)]
    for height in heights:
        parts += [height * np.sin(np.pi * np.arange(1, width) / width) ** 2, np.zeros(hold)]
    return np.concatenate(parts)


def test_every_hold_is_one_minimum_with_its_ends() -> None:
    minima = find_energy_minima(curve(humps([1.0, 0.8, 1.2])))
    assert [minimum.energy for minimum in minima] == [0.0] * 4
    assert [(minimum.at_start, minimum.at_end) for minimum in minima] == [
        (True, False), (False, False), (False, False), (False, True),
    ]  # fmt: skip
    inner = minima[1]
    assert inner.first <= 25 <= 30 <= inner.last
    assert inner.length < 6 + 8
    assert inner.drop == 0.8  # the lower maximum beside it; the median maximum is 1


def test_a_small_movement_does_not_divide_a_hold() -> None:
    values = humps([1.0, 1.0, 1.0], hold=20)
    values[48:52] += 0.15
    assert len(find_energy_minima(curve(values))) == 4
    values[48:52] += 0.3
    assert len(find_energy_minima(curve(values))) == 5


def test_a_clip_that_is_cut_within_a_movement_does_not_begin_or_end_at_rest() -> None:
    values = humps([1.0, 1.0, 1.0])[12:-12]
    first, *_, last = find_energy_minima(curve(values))
    assert not first.at_start
    assert not last.at_end
    assert first.lowest > 5


def test_a_still_curve_has_no_minima() -> None:
    assert find_energy_minima(curve(np.zeros(50))) == ()
    assert find_energy_minima(curve(np.linspace(0, 1, 50))) == ()
    assert find_energy_minima(curve(0.5 * MIN_MAXIMUM * humps([1.0, 1.0]))) == ()
    shaking = np.abs(np.random.default_rng(0).normal(size=300))
    assert find_energy_minima(curve(0.1 * shaking, noise=0.3)) == ()


@given(st.floats(0.1, 50.0), st.lists(st.floats(0.7, 1.3), min_size=3, max_size=8))
def test_size_changes_nothing_and_reversed_time_reverses_the_minima(
    scale: float, heights: list[float]
) -> None:
    values = humps(heights)
    minima = find_energy_minima(curve(values))
    scaled = find_energy_minima(curve(scale * values))
    assert [(r.first, r.last, r.at_start) for r in scaled] == [
        (r.first, r.last, r.at_start) for r in minima
    ]
    backwards = find_energy_minima(curve(values[::-1]))
    last = len(values) - 1
    assert [(last - r.last, last - r.first) for r in backwards[::-1]] == [
        (r.first, r.last) for r in minima
    ]


def test_the_usual_length_is_that_of_certain_minima_within_the_clip() -> None:
    def minimum(length: int, energy: float = 0.0, *, at_end: bool = False) -> EnergyMinimum:
        return EnergyMinimum(0, 0, length, energy, 1.0, at_start=False, at_end=at_end)

    minima = (minimum(3), minimum(5), minimum(9), minimum(90, at_end=True), minimum(40, energy=0.6))
    assert usual_length(minima) == 5.0
    assert usual_length(minima[3:]) == 4.0
