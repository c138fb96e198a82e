from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from app.analysis.descriptors.angle_sample import angle_sample
from app.analysis.descriptors.joint_angles import joint_angles
from app.analysis.descriptors.motion_sample import SAMPLES, motion_sample
from app.models.signatures.coordinates import ANGLES_OF_JOINTS, POSITIONS, Coordinates
from app.motion.frame.body_frame import BodyTrack, smooth_track
from app.motion.posing.canonical_body import ANKLE_HEIGHT
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, waving

FEET = [SUN_ROLES.index(role) for role in (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT)]
BOTH = [(POSITIONS, motion_sample), (ANGLES_OF_JOINTS, angle_sample)]


@pytest.fixture(scope="module")
def track() -> BodyTrack:
    return smooth_track(motion_of(waving()))


@pytest.mark.parametrize(("coordinates", "describe"), BOTH)
def test_a_sample_is_played_on_the_floor(
    coordinates: Coordinates, describe: Callable[[BodyTrack], FloatArray], track: BodyTrack
) -> None:
    sample = describe(track)
    played = coordinates.played(sample, 2.0)
    assert played.shape == (60, 13, 3)
    np.testing.assert_allclose(played[:, FEET, 1].min(axis=1), ANKLE_HEIGHT, atol=1e-6)
    parts = coordinates.parts(sample)
    assert parts.curves.shape == (SAMPLES, len(coordinates.channels))
    assert (parts.turn, parts.speed) == (sample[-2], sample[-1])


def test_played_angles_are_those_of_the_sample(track: BodyTrack) -> None:
    sample = angle_sample(track)
    played = ANGLES_OF_JOINTS.played(sample, SAMPLES / 30)
    bends = [i for i, name in enumerate(ANGLES_OF_JOINTS.channels) if name.endswith("bend")]
    own = ANGLES_OF_JOINTS.parts(sample).curves
    np.testing.assert_allclose(joint_angles(played, 30.0)[:, bends], own[:, bends], atol=1e-6)


def test_played_positions_are_those_of_the_sample(track: BodyTrack) -> None:
    sample = motion_sample(track)
    played = POSITIONS.played(sample, SAMPLES / 30)
    hips = played[:, [SUN_ROLES.index(JointRole.HIPS)]]
    own = POSITIONS.parts(sample).curves.reshape(SAMPLES, 13, 3)
    assert np.corrcoef((played - hips).ravel(), own.ravel())[0, 1] == pytest.approx(1.0)
    neck = played[:, SUN_ROLES.index(JointRole.NECK)] - hips[:, 0]
    assert np.linalg.norm(neck, axis=1).mean() == pytest.approx(0.5, abs=0.1)
