"""Joint orders are recognized by the body that they give."""

from __future__ import annotations

import numpy as np
import pytest

from app.formats.common.joint_trees import in_tree_order
from app.formats.npz.joint_layouts import LAYOUTS, JointLayout, layout_of
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.roles.joint_roles import ESSENTIAL_ROLES, SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from tests.formats.npz.files import npy
from tests.people import person

R = JointRole
BY_TITLE = {layout.title: layout for layout in LAYOUTS}


def moving(layout: JointLayout, frames: int = 40) -> FloatArray:
    """A body in this order. Joints are placed outward from joints of the person with like names."""
    rest = _rest(layout)
    sway = person(frames=frames, seed=2).positions
    tilt = sway[:, 3] - sway[:, 0]  # from the hips to the head, which leans a little
    lean = np.linalg.norm(tilt, axis=-1, keepdims=True)[:, None]
    spin = np.linspace(0, 1, frames)[:, None]
    x, y, z = np.moveaxis(rest * (lean / lean.mean()), -1, 0)
    return np.stack(
        [np.cos(spin) * x + np.sin(spin) * z, y, np.cos(spin) * z - np.sin(spin) * x], axis=-1
    ).astype(np.float32)


def _rest(layout: JointLayout) -> FloatArray:
    """(joints, 3) a T-pose whose bones have different lengths, but equal ones left and right."""
    rng = np.random.default_rng(7)
    pairs = dict(layout.paired_bones())
    offsets = np.zeros((len(layout.names), 3))
    directions = (("Leg", 0, -1), ("Knee", 0, -1), ("Ankle", 0, -1), ("Arm", 1, 0), ("Hip", 1, -1))
    for joint, name in enumerate(layout.names):
        side, up = next(((s, u) for part, s, u in directions if part in name), (1, 0))
        if joint in pairs:
            offset = rng.uniform(0.1, 0.5) * np.array([side, up, 0.1]) + [0.02, 0, 0]
            offsets[joint], offsets[pairs[joint]] = offset, offset * [-1, 1, 1]
        elif joint not in pairs.values():
            offsets[joint] = [0, rng.uniform(0.1, 0.4), 0.02]
    rest = np.zeros_like(offsets)
    for joint in in_tree_order(np.array(layout.parents)):
        parent = layout.parents[joint]
        rest[joint] = offsets[joint] + (rest[parent] if parent >= 0 else 0)
    return rest


@pytest.mark.parametrize("title", BY_TITLE)
def test_each_order_is_recognized_by_its_body(title: str) -> None:
    layout = BY_TITLE[title]
    assert layout_of(moving(layout)) is layout


@pytest.mark.parametrize("title", BY_TITLE)
def test_each_order_is_a_tree_with_left_and_right(title: str) -> None:
    layout = BY_TITLE[title]
    assert len(set(layout.names)) == len(layout.names) == len(layout.parents)
    assert layout.parents.count(-1) == 1
    assert sorted(in_tree_order(np.array(layout.parents))) == list(range(len(layout.names)))
    assert 2 * len(layout.paired_bones()) >= 0.6 * len(layout.names)


def test_another_order_with_the_same_number_of_joints_is_not_recognized() -> None:
    shuffled = moving(BY_TITLE["SMPL"])[:, np.random.default_rng(0).permutation(24)]
    assert layout_of(shuffled) is None
    assert layout_of(np.zeros((5, 24, 3))) is None
    assert layout_of(np.random.default_rng(0).normal(size=(50, 17, 3))) is None
    assert layout_of(np.zeros((5, 19, 3))) is None


@pytest.mark.parametrize("title", ["SMPL", "SMPL body", "SMPL-H", "SMPL-X", "LAFAN1"])
def test_names_of_an_order_have_the_roles(title: str) -> None:
    recording = read_recording(npy(moving(BY_TITLE[title])))
    assert [c.code for c in recording.cautions] == ["joint_names_guessed"]
    assert title in recording.cautions[0].detail
    motion = canonicalize(recording, frame_rate=30.0)
    assert set(motion.roles) >= set(SUN_ROLES)
    left = motion.names[motion.roles[R.LEFT_KNEE]]
    assert left.startswith("L")


@pytest.mark.parametrize("title", ["Human3.6M", "Kinect v2", "OpenPose BODY_25"])
def test_orders_without_some_joints_still_have_the_essential_roles(title: str) -> None:
    motion = canonicalize(read_recording(npy(moving(BY_TITLE[title]))), frame_rate=30.0)
    assert set(motion.roles) >= set(ESSENTIAL_ROLES)
    assert {motion.names[motion.roles[r]] for r in (R.LEFT_HAND, R.RIGHT_HAND)} <= {
        "LeftHand", "RightHand", "WristLeft", "WristRight",
    }  # fmt: skip
