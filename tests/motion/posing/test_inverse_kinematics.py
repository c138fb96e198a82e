from __future__ import annotations

import numpy as np
import pytest

from app.motion.posing.inverse_kinematics import ancestors, pose_to
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import local_translations
from app.motion.skeleton.skeleton import Skeleton
from tests.people import ROLES, body_skeleton, swaying_rotations

JOINTS = {role: ROLES.index(role) for role in ROLES}
COLUMNS = [JOINTS[role] for role in SUN_ROLES]


def animation(size: float, seed: int = 0, frames: int = 20) -> Animation:
    skeleton = body_skeleton()
    rotations = swaying_rotations(frames, len(skeleton), seed, size)
    roots = np.tile(skeleton.offsets[0] + np.array([0.3, 0.0, -0.2]), (frames, 1))
    return Animation(skeleton, rotations, local_translations(skeleton, roots), 30.0)


def test_roles_reach_their_targets_with_the_same_bones() -> None:
    targets = animation(0.5, seed=3).positions()[:, COLUMNS]
    start = animation(0.1)
    found = pose_to(start, JOINTS, targets)
    off = np.linalg.norm(found.positions()[:, COLUMNS] - targets, axis=-1)
    before = np.linalg.norm(start.positions()[:, COLUMNS] - targets, axis=-1)
    assert off.mean() < 0.01 < 0.1 * before.mean() * 2
    assert off[:, [2, 3]].max() < 0.01  # feet
    np.testing.assert_array_equal(found.translations[:, 1:], start.translations[:, 1:])
    np.testing.assert_allclose(np.linalg.norm(found.rotations, axis=-1), 1.0, atol=1e-9)


def test_a_pose_at_its_targets_does_not_change() -> None:
    start = animation(0.3, seed=1)
    found = pose_to(start, JOINTS, start.positions()[:, COLUMNS])
    np.testing.assert_allclose(found.positions(), start.positions(), atol=1e-6)


def test_joints_without_targets_keep_their_pose() -> None:
    start = animation(0.2, seed=2)
    found = pose_to(start, JOINTS, animation(0.4, seed=5).positions()[:, COLUMNS])
    foot = JOINTS[JointRole.LEFT_FOOT]  # its turn only moves the toes
    np.testing.assert_array_equal(found.rotations[:, foot], start.rotations[:, foot])


def test_a_root_above_the_hips_does_not_turn_and_roles_may_be_missing() -> None:
    body = animation(0.2)
    names = ("world", *body.skeleton.names)
    parents = np.concatenate([[-1], body.skeleton.parents + 1])
    offsets = np.vstack([np.zeros(3), body.skeleton.offsets])
    rotations = np.concatenate([np.tile([1.0, 0, 0, 0], (20, 1, 1)), body.rotations], axis=1)
    translations = np.concatenate([np.zeros((20, 1, 3)), body.translations], axis=1)
    start = Animation(Skeleton(names, parents, offsets), rotations, translations, 30.0)
    joints = {role: joint + 1 for role, joint in JOINTS.items() if role != JointRole.HEAD}
    targets = animation(0.4, seed=4).positions()[:, COLUMNS]
    found = pose_to(start, joints, targets)
    np.testing.assert_array_equal(found.rotations[:, 0], start.rotations[:, 0])
    columns = [joints[role] for role in SUN_ROLES if role in joints]
    present = [i for i, role in enumerate(SUN_ROLES) if role in joints]
    off = np.linalg.norm(found.positions()[:, columns] - targets[:, present], axis=-1)
    assert off.mean() < 0.02
    assert ancestors(start.skeleton, joints[JointRole.HIPS]) == [0]


@pytest.mark.parametrize("frames", [1, 2])
def test_a_frame_or_two_are_enough(frames: int) -> None:
    start = animation(0.2, frames=frames)
    found = pose_to(start, JOINTS, animation(0.3, seed=6, frames=frames).positions()[:, COLUMNS])
    assert np.isfinite(found.rotations).all()
