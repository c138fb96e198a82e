"""The unit is judged from the body's own size."""

from __future__ import annotations

import pytest

from app.motion.canonical.units import METERS_PER_UNIT, confirm_unit, judge_unit, stature
from tests.people import ROLES, person

EXPECTED = {role: index for index, role in enumerate(ROLES)}


@pytest.mark.parametrize("metres_per_unit", METERS_PER_UNIT.values())
@pytest.mark.parametrize("size", [0.85, 1.0, 1.2])
def test_known_units_are_found_for_short_and_tall(metres_per_unit: float, size: float) -> None:
    recording = person(scale=size / metres_per_unit)
    unit = judge_unit(recording.positions, EXPECTED)
    assert unit.metres_per_unit == metres_per_unit
    assert not unit.cautions


def test_stature_is_about_right() -> None:
    assert stature(person().positions, EXPECTED) == pytest.approx(1.7, abs=0.1)


@pytest.mark.parametrize("scale", [1 / 3.5, 7.0, 5000.0])
def test_an_unknown_unit_is_scaled_to_a_person_and_said(scale: float) -> None:
    recording = person(scale=scale)
    unit = judge_unit(recording.positions, EXPECTED)
    height = stature(recording.positions, EXPECTED) * unit.metres_per_unit
    assert 1.0 < height < 2.6
    assert [caution.code for caution in unit.cautions] == ["unit_guessed"]


def test_no_size_is_no_crash() -> None:
    assert judge_unit(0 * person().positions, EXPECTED).metres_per_unit == 1.0


@pytest.mark.parametrize("size", [0.45, 1.0, 1.3])
def test_a_plausible_unit_of_the_file_is_believed(size: float) -> None:
    recording = person(scale=size * 100)
    unit = confirm_unit(0.01, recording.positions, EXPECTED)
    assert unit.metres_per_unit == 0.01
    assert not unit.cautions


@pytest.mark.parametrize("declared", [1.0, 0.0001])
def test_a_scale_that_the_numbers_do_not_follow_is_doubted(declared: float) -> None:
    recording = person(scale=100)
    unit = confirm_unit(declared, recording.positions, EXPECTED)
    assert unit.metres_per_unit == 0.01
    assert [caution.code for caution in unit.cautions] == ["unit_suspect"]
