from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.angle_poses import poses_of_angles
from app.analysis.descriptors.joint_angles import ANGLES, joint_angles
from app.motion.roles.joint_roles import SUN_ROLES, JointRole


def random_angles(rng: np.random.Generator, count: int) -> np.ndarray:
    """(count, 20) angles of poses with bent knees and elbows, whose turns can be seen."""
    angles = rng.uniform(-1.2, 1.2, (count, len(ANGLES)))
    bends = [place for place, name in enumerate(ANGLES) if name.endswith("bend")]
    angles[:, bends] = rng.uniform(0.4, 2.5, (count, len(bends)))
    return angles


def test_poses_have_the_angles_that_they_were_made_of() -> None:
    angles = random_angles(np.random.default_rng(3), 50)
    np.testing.assert_allclose(joint_angles(poses_of_angles(angles), 30.0), angles, atol=1e-9)


def test_bones_do_not_change_their_length() -> None:
    poses = poses_of_angles(random_angles(np.random.default_rng(4), 20))
    at = {role: poses[:, place] for place, role in enumerate(SUN_ROLES)}
    for start, end in (
        (JointRole.HIPS, JointRole.NECK),
        (JointRole.LEFT_KNEE, JointRole.LEFT_FOOT),
        (JointRole.RIGHT_ELBOW, JointRole.RIGHT_HAND),
        (JointRole.LEFT_SHOULDER, JointRole.RIGHT_SHOULDER),
    ):
        lengths = np.linalg.norm(at[end] - at[start], axis=-1)
        np.testing.assert_allclose(lengths, lengths[0])


@pytest.mark.parametrize("pitch", [np.pi / 2, -np.pi / 2, np.pi])
def test_a_level_or_inverted_spine_gives_finite_poses(pitch: float) -> None:
    angles = np.zeros((1, len(ANGLES)))
    angles[0, 0] = pitch
    assert np.isfinite(poses_of_angles(angles)).all()
    angles[0, :2] = 0.0, pitch
    assert np.isfinite(poses_of_angles(angles)).all()
