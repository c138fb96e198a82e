"""Forward kinematics agrees with its slow twin."""

from __future__ import annotations

import numpy as np

from app.motion.skeleton.kinematics import forward_kinematics, joints_by_depth, local_translations
from app.motion.skeleton.rotations import quaternions_to_matrices
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.people import body_skeleton, swaying_rotations


def naive_forward_kinematics(
    skeleton: Skeleton, rotations: FloatArray, translations: FloatArray
) -> FloatArray:
    """The positions by 4x4 matrices, one for each joint and frame."""
    positions = np.zeros(translations.shape)
    for frame in range(len(rotations)):
        worlds: list[FloatArray] = []
        for joint, parent in enumerate(skeleton.parents):
            local = np.eye(4)
            local[:3, :3] = quaternions_to_matrices(rotations[frame, joint])
            local[:3, 3] = translations[frame, joint]
            worlds.append(local if parent < 0 else worlds[parent] @ local)
            positions[frame, joint] = worlds[joint][:3, 3]
    return positions


def test_positions_agree_with_4x4_matrices() -> None:
    skeleton = body_skeleton()
    rng = np.random.default_rng(0)
    rotations = swaying_rotations(7, len(skeleton), size=2.0)
    translations = local_translations(skeleton, rng.normal(size=(7, 3)))
    translations += rng.normal(scale=0.01, size=translations.shape)
    found = forward_kinematics(skeleton, rotations, translations)
    assert np.allclose(found, naive_forward_kinematics(skeleton, rotations, translations))


def test_several_roots_are_independent() -> None:
    skeleton = Skeleton(
        ("a", "b", "c"), np.array([-1, -1, 1]), np.array([[0.0, 0, 0], [1, 0, 0], [0, 2, 0]])
    )
    rotations = swaying_rotations(3, 3)
    translations = local_translations(skeleton, np.ones((3, 3)))
    found = forward_kinematics(skeleton, rotations, translations)
    assert np.allclose(found, naive_forward_kinematics(skeleton, rotations, translations))
    assert np.allclose(found[:, 1], [1, 0, 0])


def test_joints_by_depth_has_each_joint_once_after_its_parent() -> None:
    parents = body_skeleton().parents
    levels = joints_by_depth(parents)
    assert sorted(np.concatenate(levels)) == list(range(len(parents)))
    assert all(
        parents[joint] in levels[depth] for depth, level in enumerate(levels[1:]) for joint in level
    )
