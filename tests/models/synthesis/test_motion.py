from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import clearance, moments_of, motion_shape
from app.models.synthesis.body import Donor, embody, same_body
from app.models.synthesis.motion import course_of
from app.motion.frame.body_frame import BodyTrack, body_track
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation, animation_of_positions
from app.numerics.arrays import FloatArray
from tests.bodies import motion_of, standing, walking, waving


def track_of(positions: FloatArray) -> BodyTrack:
    return body_track(motion_of(positions))


def donor(positions: FloatArray) -> Donor:
    names = [role.value for role in SUN_ROLES]
    parents = np.array(SUN_PARENTS)
    order = np.argsort(
        [0 if p < 0 else 1 + _depth(i) for i, p in enumerate(parents)], kind="stable"
    )
    place = {int(old): new for new, old in enumerate(order)}
    above = np.array([-1 if parents[old] < 0 else place[int(parents[old])] for old in order])
    animation = animation_of_positions([names[i] for i in order], above, positions[:, order], 30.0)
    return Donor(
        animation, track_of(positions), {SUN_ROLES[old]: new for old, new in place.items()}
    )


def _depth(joint: int) -> int:
    return 0 if SUN_PARENTS[joint] < 0 else 1 + _depth(SUN_PARENTS[joint])


def test_a_cycle_is_repeated_without_a_jump_for_the_requested_time() -> None:
    walk = track_of(walking(6.0, steps_hz=0.9))
    course = course_of(motion_shape(walk), walk.body_length, seconds=5.0)
    frames = len(course.positions) / course.cycles
    assert frames == 33
    assert course.cycles == 5
    steps = np.linalg.norm(np.diff(course.positions, axis=0), axis=-1)
    bends = np.linalg.norm(np.diff(course.positions, 2, axis=0), axis=-1)
    seams = np.arange(1, course.cycles) * 33 - 1
    assert bends[seams].max() <= 1.2 * np.delete(bends, seams, axis=0).max()
    assert steps[seams].max() <= 1.2 * np.delete(steps, seams, axis=0).max()


def test_a_walk_has_the_same_speed_and_turn() -> None:
    walk = track_of(walking(6.0, speed=1.2, turn=0.3))
    shape = motion_shape(walk)
    course = course_of(shape, walk.body_length, seconds=4.0)
    again = track_of(course.positions)
    assert again.yaw_rate().mean() == pytest.approx(0.3, abs=0.05)
    np.testing.assert_allclose(motion_shape(again)[:-2].reshape(32, 43)[:, :39],
                               shape[:-2].reshape(32, 43)[:, :39], atol=0.1)  # fmt: skip


def test_a_motion_that_is_not_cyclic_keeps_the_detail_of_a_take() -> None:
    wave = track_of(waving(8.0, hz=2.0))
    shape = motion_shape(wave)
    target_shape = np.array(shape)
    target_shape[:-2].reshape(32, 43)[:, 39] += 0.1  # all of it, higher
    bare = course_of(target_shape, wave.body_length)
    full = course_of(
        target_shape, wave.body_length, take=moments_of(wave), take_shape=shape.astype(np.float64)
    )
    hand = [np.abs(np.diff(c.positions[:, -1, 0])).mean() for c in (bare, full)]
    real = np.abs(np.diff(wave.positions[:, -1, 0])).mean()
    assert hand[1] == pytest.approx(real, rel=0.1)
    assert hand[0] < 0.8 * real
    lift = (
        full.positions[:, 4, 1].mean()
        - course_of(shape, wave.body_length).positions[:, 4, 1].mean()
    )
    assert lift == pytest.approx(0.1 * wave.body_length, rel=0.05)
    assert full.cycles == 0
    short = course_of(target_shape, wave.body_length, seconds=2.0)
    assert len(short.positions) == 60


def test_a_take_that_steps_is_not_left_in_the_air_by_another_posture() -> None:
    steps = np.array(standing(240))
    foot = [SUN_ROLES.index(role) for role in (JointRole.LEFT_FOOT, JointRole.RIGHT_FOOT)]
    swing = 0.1 * np.sin(2 * np.pi * 2.0 * np.arange(len(steps)) / 30)
    for side, lift in zip(foot, (np.maximum(swing, 0), np.maximum(-swing, 0)), strict=True):
        steps[:, side, 1] += lift
    track = track_of(steps)
    shape = motion_shape(track).astype(np.float64)
    target_shape = np.array(shape)
    moments = target_shape[:-2].reshape(32, 43)
    moments[:, 3 * foot[0] + 1] += 0.15  # on the right foot only, no higher over the floor
    moments[:, 39] += clearance(shape[:-2].reshape(32, 43)) - clearance(moments)
    course = course_of(target_shape, track.body_length, take=moments_of(track), take_shape=shape)
    real = steps[:, :, 1].min(axis=1)
    lowest = course.positions[:, :, 1].min(axis=1)
    np.testing.assert_allclose(lowest - lowest.min(), real - real.min(), atol=0.02)


def test_the_body_has_the_skeleton_of_the_donors_and_feet_on_the_floor() -> None:
    walk = walking(5.0)
    donors = same_body([donor(walk), donor(1.2 * walk)])
    assert len(donors) == 1  # another body
    track = donors[0].track
    made = embody(course_of(motion_shape(track), track.body_length), donors)
    positions = made.positions()
    lengths = np.linalg.norm(made.translations[:, 1:], axis=-1)
    real = np.linalg.norm(donors[0].animation.translations[:, 1:], axis=-1)
    assert lengths.min(axis=0) == pytest.approx(real.min(axis=0), abs=0.15)
    assert np.quantile(positions[:, :, 1].min(axis=1), 0.01) == pytest.approx(0.0, abs=1e-6)
    joints = [donors[0].joints[role] for role in SUN_ROLES]
    again = motion_shape(track_of(positions[:, joints]))
    poses = [s[:-2].reshape(32, 43)[:, :39] for s in (again, motion_shape(track))]
    assert np.abs(poses[0] - poses[1]).mean() < 0.05


def test_small_motions_give_finite_bodies() -> None:
    still = standing(2)
    shape = motion_shape(track_of(still))
    course = course_of(shape, 1.5)
    made: Animation = embody(course, [donor(still)])
    assert np.isfinite(made.rotations).all()
    assert np.isfinite(made.positions()).all()


def test_a_take_is_warped_to_the_timing_of_the_shape() -> None:
    hand = SUN_ROLES.index(JointRole.RIGHT_HAND)

    def raised(at: float) -> BodyTrack:
        body = np.array(standing(180))
        body[:, hand, 1] += 0.8 * np.exp(-0.5 * ((np.arange(180) / 30 - at) / 0.25) ** 2)
        return track_of(body)

    take, target_shape = raised(2.5), motion_shape(raised(3.2)).astype(np.float64)
    course = course_of(
        target_shape, take.body_length, take=moments_of(take), take_shape=motion_shape(take)
    )
    height = course.positions[:, hand, 1]
    assert abs(int(height.argmax()) / 30 - 3.2) < 0.15
    assert 0.72 < np.ptp(height) < 0.84
    lingering = height > height.min() + 0.4  # as long as the take's, not once for either
    real = take.positions[:, hand, 1]
    assert lingering.sum() < 1.25 * (real > real.min() + 0.4).sum()
