"""Edits of a motion, against slow twins that move positions alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from app.demo import demo_clips
from app.errors import TooShort
from app.formats.read import read_recording
from app.motion.canonical.canonical import canonicalize
from app.motion.editing.edited import Edited, in_place, part
from app.motion.editing.loop import BLEND_SECONDS, best_loop, loop
from app.motion.editing.mirror import mirror
from app.motion.editing.mirrored_joints import mirrored_joints
from app.motion.posing.file_rotations import animation_of_recording
from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.animation import animation_of_positions
from app.numerics.arrays import FloatArray

TENTH_OF_MM = 1e-4


def edited_of(task: str, *, is_solved: bool = False) -> Edited:
    """A demo clip with the rotations of its file, or with solved ones."""
    (clip,) = demo_clips(("ada",), (task,), takes=1)
    recording = read_recording(clip.content)
    motion = canonicalize(recording)
    animation = animation_of_recording(recording, motion)
    if animation is None or is_solved:
        animation = animation_of_positions(
            motion.names, motion.parents, motion.positions, motion.frame_rate
        )
    return Edited(animation, motion.roles)


def mirrored_positions(edited: Edited) -> FloatArray:
    """The slow twin: each joint of the other side, reflected in the plane of the first frame."""
    positions, names = edited.animation.positions(), edited.animation.skeleton.names
    roles = edited.roles
    across = (
        positions[0, roles[JointRole.LEFT_SHOULDER]] - positions[0, roles[JointRole.RIGHT_SHOULDER]]
    )
    across[1] = 0.0
    across /= np.linalg.norm(across)
    hips = positions[0, roles[JointRole.HIPS]]
    found = np.empty_like(positions)
    for joint, name in enumerate(names):
        other = name.replace("Left", "R?").replace("Right", "Left").replace("R?", "Right")
        source = names.index(other)
        for frame in range(len(positions)):
            place = positions[frame, source] - hips
            found[frame, joint] = place - 2 * (place @ across) * across + hips
    return found


@pytest.mark.parametrize("is_solved", [False, True])
@pytest.mark.parametrize("task", ["walk", "kick"])
def test_a_mirrored_motion_has_the_mirrored_places(task: str, is_solved: bool) -> None:
    edited = edited_of(task, is_solved=is_solved)
    mirrored = mirror(edited)
    assert mirrored.animation.skeleton.names == edited.animation.skeleton.names
    error = np.abs(mirrored.animation.positions() - mirrored_positions(edited)).max()
    assert error < TENTH_OF_MM


def test_a_mirror_of_a_mirror_is_the_motion() -> None:
    edited = edited_of("kick")
    again = mirror(mirror(edited))
    assert np.abs(again.animation.positions() - edited.animation.positions()).max() < TENTH_OF_MM
    turns = np.abs(np.sum(again.animation.rotations * edited.animation.rotations, axis=-1))
    assert turns.min() > 1 - 1e-9


def test_a_mirror_keeps_the_skeleton_of_a_body_with_equal_sides() -> None:
    edited = edited_of("walk")
    before, after = edited.animation.skeleton, mirror(edited).animation.skeleton
    assert np.array_equal(before.parents, after.parents)
    assert np.abs(before.offsets - after.offsets).max() < TENTH_OF_MM


def test_a_body_whose_sides_have_other_trees_is_mirrored_too() -> None:
    """An extra joint on one side: names change places instead of motions."""
    edited = edited_of("wave")
    skeleton = edited.animation.skeleton
    hand = skeleton.names.index("LeftHand")
    longer = replace(
        skeleton,
        names=(*skeleton.names, "Sword"),
        parents=np.append(skeleton.parents, hand),
        offsets=np.vstack([skeleton.offsets, [0.5, 0.0, 0.0]]),
    )
    frames = edited.frames
    animation = replace(
        edited.animation,
        skeleton=longer,
        rotations=np.concatenate(
            [edited.animation.rotations, np.tile([1.0, 0, 0, 0], (frames, 1, 1))], axis=1
        ),
        translations=np.concatenate(
            [edited.animation.translations, np.tile([0.5, 0, 0], (frames, 1, 1))], axis=1
        ),
    )
    mirrored = mirror(Edited(animation, edited.roles)).animation
    names, positions = mirrored.skeleton.names, mirrored.positions()
    expected = mirrored_positions(edited)
    order = [names.index(name) for name in skeleton.names]
    assert np.abs(positions[:, order] - expected).max() < TENTH_OF_MM
    sword = positions[:, names.index("Sword")] - positions[:, names.index("RightHand")]
    assert np.allclose(np.linalg.norm(sword, axis=1), 0.5)


@pytest.mark.parametrize(
    ("names", "other"),
    [
        (("Hips", "LeftArm", "RightArm"), (0, 2, 1)),
        (("root", "lhipjoint", "rhipjoint", "lowerback"), (0, 2, 1, 3)),
        (("Pelvis", "Arm_L", "Arm_R", "Lid"), (0, 2, 1, 3)),
        (("b", "mixamorig:LeftHandIndex1", "mixamorig:RightHandIndex1"), (0, 2, 1)),
        (("Hips", "LeftArm", "Tail"), (0, 1, 2)),
    ],
)
def test_joints_pair_by_their_names(names: tuple[str, ...], other: tuple[int, ...]) -> None:
    assert tuple(mirrored_joints(names, {})) == other


def test_joints_pair_by_their_roles_whatever_their_names() -> None:
    roles = {JointRole.LEFT_HAND: 0, JointRole.RIGHT_HAND: 2}
    assert tuple(mirrored_joints(("a", "b", "c"), roles)) == (2, 1, 0)


def test_in_place_only_the_path_is_gone() -> None:
    edited = edited_of("walk")
    before, after = edited.animation.positions(), in_place(edited).animation.positions()
    hips = edited.roles[JointRole.HIPS]
    assert np.ptp(before[:, hips, [0, 2]], axis=0).max() > 0.5
    assert np.abs(after[:, hips, [0, 2]] - before[0, hips, [0, 2]]).max() < 1e-9
    assert np.allclose(after[..., 1], before[..., 1])
    local_before, local_after = before - before[:, [hips]], after - after[:, [hips]]
    assert np.allclose(local_before, local_after)


def cyclic(seconds: float, period: float, rate: float = 60.0) -> Edited:
    """A demo body that waves an arm with an exact period, after a different beginning."""
    edited = edited_of("walk")
    pose = edited.animation
    times = np.arange(round(seconds * rate)) / rate
    rotations = np.tile(pose.rotations[:1], (len(times), 1, 1))
    angles = 0.6 * np.sin(2 * np.pi * times / period) + 0.3 * np.exp(-3 * times)
    for name in ("LeftArm", "RightUpLeg"):
        joint = pose.skeleton.names.index(name)
        rotations[:, joint] = np.stack(
            [np.cos(angles), np.sin(angles), 0 * angles, 0 * angles], axis=-1
        )
    translations = np.tile(pose.translations[:1], (len(times), 1, 1))
    return Edited(
        replace(pose, rotations=rotations, translations=translations, frame_rate=rate),
        edited.roles,
    )


def test_the_best_loop_is_a_number_of_periods() -> None:
    edited = cyclic(seconds=6.0, period=1.2)
    track = edited.track()
    found = best_loop(track)
    periods = (found.end - found.start) / 1.2
    assert periods > 0.5
    assert abs(periods - round(periods)) < 0.06
    assert found.start >= BLEND_SECONDS
    one = best_loop(track, min_seconds=0.5, max_seconds=1.5)
    assert one.end - one.start == pytest.approx(1.2, abs=0.05)


@pytest.mark.parametrize("task", ["walk", "wave"])
def test_repeats_of_a_loop_follow_each_other_without_a_jump(task: str) -> None:
    edited = edited_of(task)
    track = edited.track()
    cut = best_loop(track)
    looped = in_place(loop(edited, cut, track))
    positions = looped.animation.positions()
    # in place, but the heading may have turned; a step of the repeat is no longer than others
    steps = np.linalg.norm(np.diff(positions, axis=0), axis=-1).max(axis=1)
    hips = edited.roles[JointRole.HIPS]
    last, first = (positions[frame] - positions[frame, hips] for frame in (-1, 0))
    turn = edited.headings(track)[[round(cut.start * edited.rate), round(cut.end * edited.rate)]]
    angle = turn[1] - turn[0]
    matrix = np.array(
        [[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]]
    )
    jump = np.linalg.norm(first @ matrix.T - last, axis=-1).max()
    assert jump < 1.5 * steps.max() + 0.01


def test_a_motion_may_be_too_short_for_a_loop() -> None:
    edited = part(edited_of("walk"), 0, 12)
    with pytest.raises(TooShort, match="loop"):
        best_loop(edited.track())
