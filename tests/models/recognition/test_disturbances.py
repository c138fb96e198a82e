from __future__ import annotations

import numpy as np
import pytest

from app.models.recognition.disturbances import faster, jitter, kept, mirrored, noise
from app.motion.roles.joint_roles import JointRole
from tests.bodies import motion_of, walking

MOTION = motion_of(walking())


def bones(positions: np.ndarray) -> np.ndarray:
    """(frames, bones) lengths in meters."""
    has = MOTION.parents >= 0
    return np.linalg.norm(positions[:, has] - positions[:, MOTION.parents[has]], axis=-1)


def test_noise_has_its_size_and_its_seed() -> None:
    noisy = noise(10.0)(MOTION, 3)
    moved = noisy.positions - MOTION.positions
    assert moved.std() == pytest.approx(0.010, rel=0.05)
    np.testing.assert_array_equal(noisy.positions, noise(10.0)(MOTION, 3).positions)
    assert (noisy.positions != noise(10.0)(MOTION, 4).positions).any()


def test_jitter_turns_bones_and_leaves_their_lengths() -> None:
    shaken = jitter(2.0)(MOTION, 0)
    np.testing.assert_allclose(bones(shaken.positions), bones(MOTION.positions), atol=1e-5)
    root = int(np.flatnonzero(MOTION.parents < 0)[0])
    np.testing.assert_array_equal(shaken.positions[:, root], MOTION.positions[:, root])
    assert np.abs(shaken.positions - MOTION.positions).max() > 0.01
    np.testing.assert_allclose(jitter(0.0)(MOTION, 0).positions, MOTION.positions, atol=1e-6)


def test_a_part_is_kept() -> None:
    half = kept(0.25, 0.75)(MOTION, 0)
    start = round(0.25 * MOTION.frames)
    assert half.frames == pytest.approx(MOTION.frames / 2, abs=1)
    np.testing.assert_array_equal(half.positions[0], MOTION.positions[start])


def test_faster_is_the_same_poses_in_less_time() -> None:
    quick = faster(1.25)(MOTION, 0)
    assert quick.duration == pytest.approx(MOTION.duration / 1.25)
    np.testing.assert_array_equal(quick.positions, MOTION.positions)


def test_mirrored_sides_change_places() -> None:
    turned = mirrored(MOTION, 0)
    left, right = (MOTION.roles[role] for role in (JointRole.LEFT_HAND, JointRole.RIGHT_HAND))
    np.testing.assert_array_equal(
        turned.positions[:, left], MOTION.positions[:, right] * np.float32([-1, 1, 1])
    )
    np.testing.assert_array_equal(mirrored(turned, 0).positions, MOTION.positions)
