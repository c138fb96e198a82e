"""Rotations and translations give the positions, for all positions."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from app.motion.skeleton.animation import (
    MAX_STILL_DISTANCE,
    Animation,
    animation_of_positions,
    animation_of_rotations,
    continuous,
    solve_rotations,
)
from app.motion.skeleton.kinematics import local_translations
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray
from tests.people import CONVENTIONS, body_skeleton, person, swaying_rotations

TENTH_OF_MM = 1e-4


def parents_and_positions() -> st.SearchStrategy[tuple[FloatArray, FloatArray]]:
    def make(joints: int, frames: int, seed: int, stiff: bool) -> tuple[FloatArray, FloatArray]:
        rng = np.random.default_rng(seed)
        parents = np.array([-1] + [int(rng.integers(-1, joint)) for joint in range(1, joints)])
        positions = rng.normal(size=(1 if stiff else frames, joints, 3)).astype(np.float32)
        return parents, np.repeat(positions, frames if stiff else 1, axis=0)

    return st.builds(
        make, st.integers(1, 9), st.integers(1, 6), st.integers(0, 10_000), st.booleans()
    )


@settings(max_examples=80, deadline=None)
@given(parents_and_positions())
def test_any_positions_are_recovered(drawn: tuple[FloatArray, FloatArray]) -> None:
    parents, positions = drawn
    names = [f"j{joint}" for joint in range(len(parents))]
    animation = animation_of_positions(names, parents, positions, 30.0)
    assert np.abs(animation.positions() - positions).max() < 1e-5
    np.testing.assert_allclose(np.linalg.norm(animation.rotations, axis=-1), 1, atol=1e-9)


def test_a_body_with_fixed_bone_lengths_has_no_translations() -> None:
    recording = person(CONVENTIONS["MotionBuilder"], frames=60)
    skeleton = recording.skeleton
    animation = animation_of_positions(skeleton.names, skeleton.parents, recording.positions, 30.0)
    moving = np.flatnonzero(animation.moving_joints())
    assert moving.tolist() == [0]
    assert np.abs(animation.positions() - recording.positions).max() < 2e-6
    fixed_bones = Animation(
        animation.skeleton,
        animation.rotations,
        local_translations(animation.skeleton, animation.translations[:, 0]),
        30.0,
    )
    assert np.abs(fixed_bones.positions() - recording.positions).max() < TENTH_OF_MM


def test_a_bone_that_stretches_has_a_translation() -> None:
    positions = np.zeros((4, 3, 3), dtype=np.float32)
    positions[:, 1, 1] = 1
    positions[:, 2, 1] = [2, 2, 2.5, 2]
    animation = animation_of_positions("abc", np.array([-1, 0, 1]), positions, 30.0)
    assert animation.moving_joints().tolist() == [True, False, True]


def test_solved_rotations_are_near_the_true_ones_if_bones_determine_them() -> None:
    skeleton = body_skeleton()
    rotations = swaying_rotations(30, len(skeleton), seed=4)
    roots = np.zeros((30, 3))
    truth = Animation(skeleton, rotations, local_translations(skeleton, roots), 30.0)
    positions = truth.positions()
    bones = positions - positions[:, skeleton.parents.clip(0)]
    solved = solve_rotations(skeleton, bones)
    # Hips and chest have three children each, which determine their rotations.
    for joint in (0, 1):
        same = np.abs(np.sum(solved[:, joint] * rotations[:, joint], axis=-1))
        assert same.min() > 1 - 1e-9


def test_a_single_bone_turns_by_the_shortest_rotation() -> None:
    skeleton = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 1, 0]]))
    angles = np.linspace(0, 3.1, 20)
    bones = np.zeros((20, 2, 3))
    bones[:, 1] = np.stack([np.zeros(20), np.cos(angles), np.sin(angles)], axis=-1)
    solved = solve_rotations(skeleton, bones)
    expected = Rotation.from_rotvec(np.outer(angles, [1, 0, 0])).as_quat(scalar_first=True)
    np.testing.assert_allclose(solved[:, 0], expected, atol=1e-5)


def test_bones_without_length_and_reversed_bones_give_finite_rotations() -> None:
    skeleton = Skeleton(("a", "b"), np.array([-1, 0]), np.array([[0.0, 0, 0], [0, 1, 0]]))
    bones = np.array([[[0.0, 0, 0], [0, 0, 0]], [[0, 0, 0], [0, -1, 0]]])
    solved = solve_rotations(skeleton, bones)
    np.testing.assert_allclose(solved[0, 0], [1, 0, 0, 0], atol=1e-9)
    assert np.isfinite(solved).all()


def test_translations_lead_from_given_rotations_to_given_positions() -> None:
    skeleton, rotations = body_skeleton(), swaying_rotations(20, 18, seed=1)
    positions = np.random.default_rng(0).normal(size=(20, 18, 3))
    animation = animation_of_rotations(skeleton, rotations, positions, 30.0)
    assert animation.rotations is rotations
    np.testing.assert_allclose(animation.positions(), positions, atol=1e-12)
    true = animation_of_rotations(
        skeleton,
        rotations,
        Animation(
            skeleton, rotations, local_translations(skeleton, np.zeros((20, 3))), 30.0
        ).positions(),
        30.0,
    )
    assert np.abs(true.translations[:, 1:] - skeleton.offsets[1:]).max() < MAX_STILL_DISTANCE


def test_signs_are_continuous_and_rotations_do_not_change() -> None:
    rotations = swaying_rotations(40, 3, seed=2, size=3.0)
    flipped = rotations * np.random.default_rng(0).choice([-1, 1], size=(40, 3, 1))
    smooth = continuous(flipped)
    assert (np.sum(smooth[1:] * smooth[:-1], axis=-1) > 0).all()
    np.testing.assert_allclose(np.abs(np.sum(smooth * rotations, axis=-1)), 1)


@pytest.mark.parametrize("rate", [15.0, 24.0, 60.0, 120.0])
def test_resampling_keeps_bone_lengths_and_positions(rate: float) -> None:
    recording = person(frames=90, seed=3)
    assert recording.rotations is not None
    skeleton = recording.skeleton
    animation = animation_of_rotations(skeleton, recording.rotations, recording.positions, 30.0)
    other = animation.resampled(rate)
    assert len(other.rotations) == int(89 / 30 * rate) + 1
    positions = other.positions()
    bones = np.linalg.norm(positions[:, 1:] - positions[:, skeleton.parents[1:]], axis=-1)
    assert bones.std(axis=0).max() < 1e-5
    step = rate / 30.0
    if step.is_integer():
        assert np.abs(positions[:: int(step)] - recording.positions).max() < 1e-4
    assert np.abs(positions[-1] - recording.positions[-1]).max() < 0.02
