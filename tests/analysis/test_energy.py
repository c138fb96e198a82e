"""Energy: what moves, seen from the floor and from the waist."""

from __future__ import annotations

import numpy as np
import pytest

from app.analysis.energy import EnergyMethod, energies
from app.motion.body_frame import body_track
from app.motion.joint_roles import SUN_ROLES, JointRole
from tests.bodies import motion_of, place, standing, turned_about_y, walking


def test_a_body_that_slides_has_global_energy_only() -> None:
    body = standing(60) + np.arange(60)[:, None, None] / 30 * np.array([0.0, 0.0, 2.0])
    track = body_track(motion_of(body))
    for method in EnergyMethod:
        found = energies(track, method)
        np.testing.assert_allclose(found.global_energy, 2.0 / track.body_length, rtol=1e-3)
        np.testing.assert_allclose(found.local_energy, 0.0, atol=1e-3)


def test_limbs_that_move_against_each_other_cancel_as_printed_but_not_by_rms() -> None:
    body = standing(60)
    swing = 0.3 * np.sin(np.arange(60) / 5)[:, None] * np.array([0.0, 0.0, 1.0])
    place(body, JointRole.LEFT_HAND, swing)
    place(body, JointRole.RIGHT_HAND, -swing)
    track = body_track(motion_of(body))
    assert energies(track, EnergyMethod.PRINTED).local_energy.max() < 1e-3
    assert energies(track, EnergyMethod.RMS).local_energy.max() > 0.1


def test_rms_of_one_moving_joint_is_its_speed_over_root_13() -> None:
    body = standing(60)
    place(body, JointRole.HEAD, np.arange(60)[:, None] / 30 * np.array([0.0, 0.1, 0.0]))
    track = body_track(motion_of(body))
    expected = 0.1 / track.body_length / np.sqrt(len(SUN_ROLES))
    np.testing.assert_allclose(energies(track).global_energy, expected, rtol=1e-3)


@pytest.mark.parametrize("method", EnergyMethod)
def test_place_heading_and_size_change_nothing(method: EnergyMethod) -> None:
    body = walking(turn=0.5)
    one = energies(body_track(motion_of(body)), method)
    moved = turned_about_y(body, 2.0) * 1.7 + [3.0, 0.5, -4.0]
    other = energies(body_track(motion_of(moved)), method)
    np.testing.assert_allclose(other.global_energy, one.global_energy, atol=2e-3)
    np.testing.assert_allclose(other.local_energy, one.local_energy, atol=2e-3)


def test_stillness_has_none() -> None:
    found = energies(body_track(motion_of(standing(2))))
    assert (found.global_energy == 0).all()
    assert (found.local_energy == 0).all()
