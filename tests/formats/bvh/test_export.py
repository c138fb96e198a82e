"""Exported BVH files are read back with the same positions, for all movements and names."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.formats.bvh.export import bvh_name, write_animation_bvh
from app.formats.bvh.reader import read_bvh
from app.motion.skeleton.animation import Animation, animation_of_positions
from app.motion.skeleton.recording import Recording
from tests.formats.gltf.test_writer import ANIMATIONS, a_person

TENTH_OF_MM = 1e-4


def there_and_back(animation: Animation) -> tuple[Recording, list[int]]:
    """The recording that is read back, and the joint of the animation for each of its joints."""
    order = []
    for root in np.flatnonzero(animation.skeleton.parents < 0):
        waiting = [int(root)]
        while waiting:
            order.append(waiting.pop())
            waiting += animation.skeleton.children(order[-1])[::-1]
    return read_bvh(b"".join(write_animation_bvh(animation))), order


@pytest.mark.parametrize("name", ANIMATIONS)
def test_positions_are_read_back_within_a_tenth_of_a_millimeter(name: str) -> None:
    animation = ANIMATIONS[name]()
    recording, order = there_and_back(animation)
    found = recording.positions / 100.0
    assert np.abs(found - animation.positions()[:, order]).max() < TENTH_OF_MM
    assert recording.frame_rate == pytest.approx(animation.frame_rate, rel=1e-4)


@settings(max_examples=60, deadline=None)
@given(
    joints=st.integers(1, 8), frames=st.integers(1, 5), seed=st.integers(0, 9999),
    names=st.lists(st.text(max_size=12), min_size=8, max_size=8),
)  # fmt: skip
def test_any_skeleton_is_read_back(joints: int, frames: int, seed: int, names: list[str]) -> None:
    rng = np.random.default_rng(seed)
    parents = np.array([int(rng.integers(-1, joint)) if joint else -1 for joint in range(joints)])
    positions = (5 * rng.normal(size=(frames, joints, 3))).astype(np.float32)
    animation = animation_of_positions(names[:joints], parents, positions, 60.0)
    recording, order = there_and_back(animation)
    assert np.abs(recording.positions / 100.0 - positions[:, order]).max() < TENTH_OF_MM
    assert list(recording.skeleton.names) == [bvh_name(names[joint]) for joint in order]


def test_long_chains_keep_their_positions() -> None:
    rng = np.random.default_rng(0)
    steps = rng.normal(size=(20, 30, 3))
    steps /= np.linalg.norm(steps, axis=-1, keepdims=True) * 10
    positions = np.cumsum(steps, axis=1).astype(np.float32)
    names = [f"j{i}" for i in range(30)]
    animation = animation_of_positions(names, np.arange(30) - 1, positions, 30.0)
    recording, _ = there_and_back(animation)
    assert np.abs(recording.positions / 100.0 - positions).max() < TENTH_OF_MM


def test_joints_with_constant_offsets_have_three_channels() -> None:
    animation = a_person()
    recording, order = there_and_back(animation)
    assert order == list(range(len(order)))
    assert recording.translations is None
    assert recording.rotations is not None
    same = np.abs(np.sum(recording.rotations * animation.rotations, axis=-1))
    assert same.min() > 1 - 1e-6


def test_every_leaf_has_an_end_site_for_other_programs() -> None:
    text = b"".join(write_animation_bvh(a_person())).decode()
    assert text.count("End Site") == 5  # head (its own), two hands, two toes


@pytest.mark.parametrize(
    ("name", "written"),
    [("a{b}", "a_b_"), (" a \t b\n", "a _ b_"), ("\0", "_"), ("", "joint"), ("x" * 300, "x" * 200)],
)
def test_names_are_on_one_line(name: str, written: str) -> None:
    assert bvh_name(name) == written
