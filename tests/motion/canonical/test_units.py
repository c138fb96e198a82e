"""The unit is found by the size of the body."""

from __future__ import annotations

import pytest

from app.motion.canonical.units import METERS_PER_UNIT, confirm_unit, judge_unit, stature
from tests.people import ROLES, person

EXPECTED = {role: index for index, role in enumerate(ROLES)}


@pytest.mark.parametrize("metres_per_unit", METERS_PER_UNIT.values())
@pytest.mark.parametrize("size", [0.85, 1.0, 1.2])
def test_units_are_found_for_short_and_tall_people(metres_per_unit: float, size: float) -> None:
    recording = person(scale=size / metres_per_unit)
    unit = judge_unit(recording.positions, EXPECTED)
    assert unit.metres_per_unit == metres_per_unit
    assert not unit.cautions


def test_the_stature_is_nearly_right() -> None:
    assert stature(person().positions, EXPECTED) == pytest.approx(1.7, abs=0.1)


@pytest.mark.parametrize("scale", [1 / 3.5, 7.0, 5000.0])
def test_a_body_in_an_unknown_unit_is_scaled_with_a_caution(scale: float) -> None:
    recording = person(scale=scale)
    unit = judge_unit(recording.positions, EXPECTED)
    height = stature(recording.positions, EXPECTED) * unit.metres_per_unit
    assert 1.0 < height < 2.6
    assert [caution.code for caution in unit.cautions] == ["unit_guessed"]


def test_a_body_without_size_raises_no_error() -> None:
    assert judge_unit(0 * person().positions, EXPECTED).metres_per_unit == 1.0


@pytest.mark.parametrize("size", [0.45, 1.0, 1.3])
def test_a_plausible_unit_of_the_file_is_used(size: float) -> None:
    recording = person(scale=size * 100)
    unit = confirm_unit(0.01, recording.positions, EXPECTED)
    assert unit.metres_per_unit == 0.01
    assert not unit.cautions


@pytest.mark.parametrize("declared", [1.0, 0.0001])
def test_an_implausible_unit_of_the_file_gives_a_caution(declared: float) -> None:
    recording = person(scale=100)
    unit = confirm_unit(declared, recording.positions, EXPECTED)
    assert unit.metres_per_unit == 0.01
    assert [caution.code for caution in unit.cautions] == ["unit_suspect"]


@pytest.mark.parametrize(("size", "said"), [(0.6, "1.0"), (0.5, "0.8")])
def test_a_child_in_centimeters_is_no_giant_in_inches(size: float, said: str) -> None:
    recording = person(scale=100 * size)
    unit = judge_unit(recording.positions, EXPECTED)
    assert unit.metres_per_unit == 0.01
    (caution,) = unit.cautions
    assert caution.code == "unit_guessed"
    assert f"in cm the person would be {said}" in caution.detail
    assert "in in" in caution.detail


@pytest.mark.parametrize(("scale", "power"), [(0.1, 10.0), (1e4, 1e-4), (1e5, 1e-5)])
def test_a_power_of_ten_goes_before_the_typical_stature(scale: float, power: float) -> None:
    recording = person(scale=scale * 1.1)
    unit = judge_unit(recording.positions, EXPECTED)
    assert unit.metres_per_unit == power
    assert [caution.code for caution in unit.cautions] == ["unit_guessed"]
