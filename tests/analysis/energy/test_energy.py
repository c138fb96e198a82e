"""The global and the local energy of motions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from app.analysis.energy.energy import EnergyMethod, Weights, energies
from app.motion.canonical.center_of_mass import ROLE_MASSES, center_of_mass
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.bodies import motion_of, move_joint, standing, turned_about_y, walking, waving
from tests.dances import dance


def test_a_body_that_slides_has_global_energy_only() -> None:
    body = standing(60) + np.arange(60)[:, None, None] / 30 * np.array([0.0, 0.0, 2.0])
    track = body_track(motion_of(body))
    for method in EnergyMethod:
        found = energies(track, method)
        np.testing.assert_allclose(found.global_energy, 2.0 / track.body_length, rtol=1e-3)
        np.testing.assert_allclose(found.local_energy, 0.0, atol=1e-3)


def test_opposite_limb_movements_cancel_in_the_printed_energy_but_not_in_rms() -> None:
    body = standing(60)
    swing = 0.3 * np.sin(np.arange(60) / 5)[:, None] * np.array([0.0, 0.0, 1.0])
    move_joint(body, JointRole.LEFT_HAND, swing)
    move_joint(body, JointRole.RIGHT_HAND, -swing)
    track = body_track(motion_of(body))
    assert energies(track, EnergyMethod.PRINTED).local_energy.max() < 1e-3
    assert energies(track, EnergyMethod.RMS).local_energy.max() > 0.1


def test_rms_of_one_moving_joint_is_its_speed_over_root_13() -> None:
    body = standing(60)
    move_joint(body, JointRole.HEAD, np.arange(60)[:, None] / 30 * np.array([0.0, 0.1, 0.0]))
    track = body_track(motion_of(body))
    expected = 0.1 / track.body_length / np.sqrt(len(SUN_ROLES))
    np.testing.assert_allclose(energies(track).global_energy, expected, rtol=1e-3)


def test_with_mass_weights_the_printed_energy_is_the_speed_of_the_center_of_mass() -> None:
    body = walking(turn=0.5)
    track = body_track(motion_of(body))
    found = energies(track, EnergyMethod.PRINTED, Weights.MASS).global_curve
    center = gaussian_filter1d(center_of_mass(track.positions), 1.0, axis=0)
    speed = np.linalg.norm(np.gradient(center, axis=0), axis=1) * 30 / track.body_length
    np.testing.assert_allclose(found.values[5:-5], speed[5:-5], rtol=1e-3)


@pytest.mark.parametrize("weights", Weights)
def test_energies_agree_with_the_equations_written_as_loops(weights: Weights) -> None:
    """A slow reference: the sums of eqs 1 and 2, and the mean square, joint by joint."""
    track = body_track(motion_of(waving()))
    shares = ROLE_MASSES if weights is Weights.MASS else [1 / 13] * 13
    for positions, scope in (
        ((track.positions - track.origin[:1, None]) / track.body_length, "global_curve"),
        (track.local, "local_curve"),
    ):
        sums, squares = np.zeros((track.frames, 3)), np.zeros(track.frames)
        for joint, share in enumerate(shares):
            padded = np.pad(positions[:, joint], ((9, 9), (0, 0)), "reflect", reflect_type="odd")
            velocity = 30 * np.gradient(gaussian_filter1d(padded, 1.0, axis=0)[9:-9], axis=0)
            sums += share * velocity
            squares += share * (velocity**2).sum(axis=1)
        printed = getattr(energies(track, EnergyMethod.PRINTED, weights), scope)
        rms = getattr(energies(track, EnergyMethod.RMS, weights), scope)
        np.testing.assert_allclose(printed.values, np.linalg.norm(sums, axis=1), atol=1e-4)
        np.testing.assert_allclose(rms.values, np.sqrt(squares), atol=2e-3)


def test_larger_noise_gets_more_smoothing_and_is_subtracted() -> None:
    clean = energies(body_track(motion_of(dance(5, 100, noise=0.0).positions, 60.0))).global_curve
    for noise, least in ((0.01, 0.97), (0.025, 0.9)):
        shaken = energies(
            body_track(motion_of(dance(5, 100, noise=noise).positions, 60.0))
        ).global_curve
        assert shaken.smoothing > clean.smoothing
        assert shaken.noise > clean.noise
        assert np.corrcoef(shaken.values, clean.values)[0, 1] > least
        assert np.median(shaken.values[clean.values < 1e-3]) < 0.1 * clean.values.max()
    assert clean.noise < 0.01


@pytest.mark.parametrize("method", EnergyMethod)
def test_position_heading_and_size_change_nothing(method: EnergyMethod) -> None:
    body = walking(turn=0.5)
    one = energies(body_track(motion_of(body)), method)
    moved = turned_about_y(body, 2.0) * 1.7 + [3.0, 0.5, -4.0]
    other = energies(body_track(motion_of(moved)), method)
    np.testing.assert_allclose(other.global_energy, one.global_energy, atol=2e-3)
    np.testing.assert_allclose(other.local_energy, one.local_energy, atol=2e-3)


def test_a_still_body_has_none() -> None:
    found = energies(body_track(motion_of(standing(2))))
    assert (found.global_energy == 0).all()
    assert (found.local_energy == 0).all()
