"""The rotations of a file, turned and scaled in the same way as its positions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from app.formats.bvh.export import write_animation_bvh
from app.formats.bvh.reader import read_bvh
from app.motion.canonical.canonical import canonicalize
from app.motion.canonical.up_axis import to_y_up
from app.motion.posing.file_rotations import UP_AXES, animation_of_recording
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import euler_to_quaternions, matrices_to_quaternions, multiply
from tests.people import CONVENTIONS, body_skeleton, person


def lying_on(axis: str, recording: Recording) -> Recording:
    """The same recording and rest pose in a world with another up axis."""
    matrix = to_y_up(np.eye(3), axis)  # row i: the new direction of axis i
    turn = matrices_to_quaternions(matrix)
    assert recording.rotations is not None
    back = turn * [1, -1, -1, -1]
    return replace(
        recording,
        skeleton=replace(recording.skeleton, offsets=recording.skeleton.offsets @ matrix.T),
        positions=recording.positions @ matrix.T.astype(np.float32),
        rotations=multiply(multiply(turn, recording.rotations), back),
        up_axis=axis[-1],
    )


@pytest.mark.parametrize("axis", UP_AXES)
@pytest.mark.parametrize("scale", [1.0, 100.0, 1 / 0.056444])
def test_positions_and_the_rotations_of_the_file_are_returned(axis: str, scale: float) -> None:
    upright = person(CONVENTIONS["MotionBuilder"], scale=scale)
    recording = lying_on(axis, upright)
    motion = canonicalize(recording, metres_per_unit=1 / scale)
    animation = animation_of_recording(recording, motion)
    assert animation is not None
    assert np.abs(animation.positions() - motion.positions).max() < 1e-5
    assert np.flatnonzero(animation.moving_joints()).tolist() == [0]
    assert upright.rotations is not None
    same = np.abs(np.sum(animation.rotations * upright.rotations, axis=-1))
    assert same.min() > 1 - 1e-6


def test_positions_are_exact_near_gimbal_lock() -> None:
    skeleton = body_skeleton(CONVENTIONS["MotionBuilder"])
    angles = np.zeros((200, len(skeleton), 3))
    angles[..., 1] = np.pi / 2 + np.linspace(-2e-3, 2e-3, 200)[:, None]
    angles[:, ::2] = 0.1
    rotations = euler_to_quaternions(angles, "ZXY").astype(np.float32)
    fixed_offsets = np.repeat(skeleton.offsets[None], 200, axis=0)
    recording = _with_positions(
        replace(
            person(CONVENTIONS["MotionBuilder"], frames=200),
            skeleton=skeleton, rotations=rotations, translations=fixed_offsets,
        )
    )  # fmt: skip
    motion = canonicalize(recording, metres_per_unit=1.0)
    animation = animation_of_recording(recording, motion)
    assert animation is not None
    back = read_bvh(b"".join(write_animation_bvh(animation))).positions / 100
    assert np.abs(back - motion.positions).max() < 1e-5


def test_joints_that_move_keep_their_translations() -> None:
    recording = person(CONVENTIONS["MotionBuilder"])
    moved = np.repeat(recording.skeleton.offsets[None], 40, axis=0)
    moved[:, 3, 1] += np.linspace(0, 0.1, 40)
    with_translations = replace(recording, translations=moved.astype(np.float32))
    again = _with_positions(with_translations)
    animation = animation_of_recording(again, canonicalize(again, metres_per_unit=1.0))
    assert animation is not None
    assert np.flatnonzero(animation.moving_joints()).tolist() == [0, 3]


def _with_positions(recording: Recording) -> Recording:
    """Positions by 4 x 4 matrices, joint by joint, as in a textbook."""
    assert recording.rotations is not None
    assert recording.translations is not None
    frames, joints = recording.rotations.shape[:2]
    world = np.zeros((frames, joints, 4, 4))
    for joint, parent in enumerate(recording.skeleton.parents):
        local = np.zeros((frames, 4, 4))
        turns = Rotation.from_quat(recording.rotations[:, joint], scalar_first=True)
        local[:, :3, :3] = turns.as_matrix()
        local[:, :3, 3] = recording.translations[:, joint]
        local[:, 3, 3] = 1
        world[:, joint] = local if parent < 0 else world[:, parent] @ local
    return replace(recording, positions=world[..., :3, 3].astype(np.float32))


def test_translations_replace_offsets_that_do_not_fit() -> None:
    recording = person(CONVENTIONS["MotionBuilder"])
    scaled = recording.positions.copy()
    scaled[:, 5:] += 0.01
    motion = canonicalize(replace(recording, positions=scaled), metres_per_unit=1.0)
    animation = animation_of_recording(replace(recording, positions=scaled), motion)
    assert animation is not None
    assert np.abs(animation.positions() - motion.positions).max() < 1e-6


def test_several_roots_have_their_own_paths() -> None:
    recording = person(CONVENTIONS["MotionBuilder"])
    parents = recording.skeleton.parents.copy()
    parents[1] = -1
    offsets = recording.skeleton.offsets.copy()
    offsets[1] = [5, 5, 5]
    apart = replace(
        recording, skeleton=replace(recording.skeleton, parents=parents, offsets=offsets)
    )
    # The trunk now has its own root, which moves as before.
    motion = canonicalize(apart, metres_per_unit=1.0)
    animation = animation_of_recording(apart, motion)
    assert animation is not None
    assert np.abs(animation.positions() - motion.positions).max() < 1e-5


def test_another_recording_gives_none() -> None:
    recording = person(CONVENTIONS["MotionBuilder"])
    motion = canonicalize(recording, metres_per_unit=1.0)
    moved = replace(recording, positions=recording.positions + np.float32(1.0))
    shorter = replace(recording, positions=recording.positions[:10])
    renamed = person(CONVENTIONS["SMPL"])
    without = replace(recording, rotations=None)
    for other in (moved, shorter, renamed, without):
        assert animation_of_recording(other, motion) is None
