"""The pose cover: every pose of a clip is within the radius of a chosen pose."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.analysis.descriptors import pose_cover as module
from app.analysis.descriptors.pose_cover import (
    FRAMES_PER_POSE,
    POSE_WIDTH,
    TOLERANCE,
    pose_cover,
    pose_vectors,
)
from app.motion.frame.body_pose import body_poses
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from tests.bodies import standing, turned_about_y, walking, waving

FRAME, RADIUS, VECTOR = 0, 1, slice(2, None)


def _distances(one: np.ndarray, others: np.ndarray) -> np.ndarray:
    return np.linalg.norm(others.astype(float) - one.astype(float), axis=1)


def _moving(seed: int, frames: int) -> np.ndarray:
    """(frames, 13, 3): joints that wander at random, now slowly, now wildly."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(size=(frames, 13, 3)) * rng.choice([0.0, 0.002, 0.05], size=(frames, 1, 1))
    return (standing(1) + np.cumsum(steps, axis=0)).astype(np.float32)


@settings(max_examples=40, deadline=None)
@given(
    seed=st.integers(0, 1000),
    frames=st.integers(2, 120),
    chunk=st.sampled_from([13, 40, 1800]),
    keyposes=st.lists(st.integers(0, 119), max_size=6),
)
def test_every_pose_is_within_the_radius_of_one_that_was_chosen(
    seed: int, frames: int, chunk: int, keyposes: list[int]
) -> None:
    positions = _moving(seed, frames)
    asked = np.array([k for k in keyposes if k < frames], dtype=int)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "CHUNK", chunk)
        cover = pose_cover(positions, asked)
    vectors = pose_vectors(positions)
    chosen = cover[:, FRAME].astype(int)
    assert np.all(np.diff(chosen) > 0)
    assert set(asked) <= set(chosen.tolist())
    assert (cover[:, VECTOR] == vectors[chosen]).all()
    for vector in vectors:
        assert (_distances(vector, cover[:, VECTOR]) <= cover[:, RADIUS]).any()


def test_slow_movement_is_covered_within_the_tolerance_by_few_poses() -> None:
    positions = walking(20.0)
    cover = pose_cover(positions, np.array([0]))
    assert cover[:, RADIUS].max() <= TOLERANCE + 1e-5
    assert len(cover) < len(positions) / FRAMES_PER_POSE / 2
    # the same cycle again and again needs no more poses
    assert len(pose_cover(walking(40.0), np.array([0]))) <= len(cover) + 2


def test_a_still_clip_is_one_pose() -> None:
    (row,) = pose_cover(standing(100), np.zeros(0, dtype=int))
    assert row[RADIUS] < 1e-5


def test_wild_movement_is_covered_by_no_more_than_its_share() -> None:
    rng = np.random.default_rng(1)
    positions = standing(400) + rng.normal(scale=0.2, size=(400, 13, 3))
    assert len(pose_cover(positions, np.zeros(0, dtype=int))) <= 400 // FRAMES_PER_POSE


def test_poses_of_no_size_are_left_out() -> None:
    positions = walking(2.0)
    positions[10:20] = 1.0
    cover = pose_cover(positions, np.array([5, 15]))
    assert 5 in cover[:, FRAME]
    assert not set(range(10, 20)) & set(cover[:, FRAME].astype(int).tolist())
    assert np.isfinite(cover).all()
    positions[:] = 0.0
    assert pose_cover(positions, np.array([5])).shape == (0, 2 + POSE_WIDTH)


def test_the_distance_of_poses_is_the_rms_of_their_joints() -> None:
    one, other = walking(1.0)[[3]], waving(1.0)[[20]]
    apart = np.linalg.norm(body_poses(one)[0] - body_poses(other)[0], axis=-1)
    assert apart[SUN_ROLES.index(JointRole.HIPS)] == 0
    expected = np.sqrt(np.square(apart).sum() / 12)
    found = np.linalg.norm(pose_vectors(one) - pose_vectors(other))
    assert found == pytest.approx(expected, rel=1e-5)
    assert found > 0.1


def test_a_pose_is_at_no_distance_from_itself_elsewhere() -> None:
    body = walking(1.0)
    moved = 1.7 * turned_about_y(body, 0.7) + np.array([3.0, 0.0, 2.0])
    np.testing.assert_allclose(pose_vectors(moved), pose_vectors(body), atol=1e-6)
