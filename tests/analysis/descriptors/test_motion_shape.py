from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import (
    SHAPE_LENGTH,
    closed,
    mirrored,
    moments_of,
    motion_shape,
    parts_of,
)
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_ROLES
from tests.bodies import motion_of, standing, walking, waving


def shape(positions: np.ndarray, rate: float = 30.0) -> np.ndarray:
    return motion_shape(body_track(motion_of(positions, rate)))


def test_its_length_is_fixed_and_all_is_finite() -> None:
    for positions in (walking(), waving(), standing(2), standing()):
        found = shape(positions)
        assert found.shape == (SHAPE_LENGTH,) == (1378,)
        assert found.dtype == np.float32
        assert np.isfinite(found).all()


def test_a_walk_is_one_mean_cycle_and_a_wave_is_the_whole_clip() -> None:
    walk, wave = parts_of(shape(walking(6.0, steps_hz=0.9))), parts_of(shape(waving(4.0)))
    assert walk.is_cyclic
    assert walk.seconds == pytest.approx(1 / 0.9, rel=0.02)
    assert not wave.is_cyclic
    assert wave.seconds == pytest.approx(4.0, rel=0.02)


def test_it_holds_how_the_body_travels_and_turns() -> None:
    track = body_track(motion_of(walking(6.0, speed=1.2, turn=0.4)))
    found = parts_of(motion_shape(track))
    forward = 1.2 / track.body_length
    np.testing.assert_allclose(found.velocities.mean(axis=0), [0, forward], atol=0.1 * forward)
    np.testing.assert_allclose(found.yaw_rates, 0.4, atol=0.05)


def test_place_size_and_phase_do_not_matter() -> None:
    walk = walking(8.0)
    np.testing.assert_allclose(shape(walk[:200]), shape(walk[13:213]), atol=0.03)
    np.testing.assert_allclose(shape(1.3 * walk + [4.0, 0.5, -7.0]), shape(walk), atol=1e-3)


def test_a_cycle_that_drifts_is_closed_without_a_jump() -> None:
    angles = 2 * np.pi * np.arange(33) / 32
    found = closed(np.sin(angles) + np.linspace(0, 0.5, 33))
    np.testing.assert_allclose(found, np.sin(angles[:-1]) + 0.25, atol=1e-12)


def test_the_mirror_of_a_motion_is_the_motion_of_the_mirrored_body() -> None:
    swapped = [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]
    for positions in (waving(), walking(8.0, turn=0.2, arm=0.4)):
        other = positions[:, swapped] * [-1, 1, 1]
        there = mirrored(shape(positions)[None])[0]
        np.testing.assert_allclose(there, shape(other), atol=0.03)
        np.testing.assert_allclose(mirrored(there[None])[0], shape(positions), atol=1e-6)


def test_moments_are_those_of_every_frame() -> None:
    track = body_track(motion_of(walking(2.0)))
    assert moments_of(track).shape == (track.frames, 43)
