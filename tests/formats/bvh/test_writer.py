"""Written BVH files are read back with the same motion."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from app.formats.bvh.reader import read_bvh
from app.formats.bvh.writer import write_bvh
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.rotations import euler_to_quaternions
from app.motion.skeleton.skeleton import Skeleton
from tests.people import CONVENTIONS, person

ORDERS = ["".join(order) for order in permutations("XYZ")]


@st.composite
def skeletons(draw: st.DrawFn) -> Skeleton:
    joints = draw(st.integers(1, 8))
    parents = [-1] + [draw(st.integers(0, joint - 1)) for joint in range(1, joints)]
    ends = draw(st.lists(st.integers(0, joints - 1), max_size=3))
    numbers = st.floats(-100, 100).map(lambda number: round(number, 4))
    return Skeleton(
        names=tuple(f"joint {joint}" for joint in range(joints)),
        parents=np.array(parents),
        offsets=draw(arrays(np.float64, (joints, 3), elements=numbers)),
        end_parents=np.array(ends, dtype=np.int64),
        end_offsets=draw(arrays(np.float64, (len(ends), 3), elements=numbers)),
    )


@settings(max_examples=60, deadline=None)
@given(
    skeleton=skeletons(),
    frames=st.integers(1, 4),
    order=st.sampled_from(ORDERS),
    rate=st.sampled_from([24.0, 29.97, 30.0, 120.0]),
    seed=st.integers(0, 1000),
)
def test_motions_are_read_back(
    skeleton: Skeleton, frames: int, order: str, rate: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    rotations = euler_to_quaternions(rng.uniform(-3, 3, (frames, len(skeleton), 3)), "XYZ")
    roots = rng.uniform(-100, 100, (frames, 3))
    recording = read_bvh(write_bvh(skeleton, rotations, roots, rate, order))
    expected = forward_kinematics(skeleton, rotations, local_translations(skeleton, roots))
    # The writer writes joints depth first, but a skeleton may have another order.
    order_read = [skeleton.names.index(name) for name in recording.skeleton.names]
    assert sorted(order_read) == list(range(len(skeleton)))
    assert np.allclose(recording.positions, expected[:, order_read], atol=1e-2)
    assert recording.frame_rate == pytest.approx(rate)
    assert len(recording.skeleton.end_parents) == len(skeleton.end_parents)
    assert recording.cautions == ()


def test_a_person_is_read_back_joint_by_joint() -> None:
    before = person(CONVENTIONS["MotionBuilder"])
    assert before.rotations is not None
    content = write_bvh(before.skeleton, before.rotations, before.positions[:, 0], 30.0)
    after = read_bvh(content)
    assert after.skeleton.names == before.skeleton.names
    assert np.allclose(after.skeleton.offsets, before.skeleton.offsets)
    assert np.allclose(after.positions, before.positions, atol=1e-4)
