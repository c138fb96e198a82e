from __future__ import annotations

import numpy as np
import pytest

from app.analysis.descriptors.motion_shape import moments_of, motion_shape
from app.models.synthesis.motion import course_of
from app.motion.frame.body_frame import body_track
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from app.services.synthesis.donors import detail_of
from tests.bodies import motion_of, waving


def fastest(target: FloatArray, take: FloatArray, take_shape: FloatArray) -> tuple[float, float]:
    """Largest movement of a joint role between two frames: the first two, and any others."""
    course = course_of(target, 1.5, take=take, take_shape=take_shape)
    steps = np.linalg.norm(np.diff(course.positions, axis=0), axis=-1).max(axis=1)
    return float(steps[:2].max()), float(steps[2:].max())


@pytest.mark.parametrize("learned", ["of such takes", "of others"])
def test_a_take_that_begins_in_a_t_pose_is_followed_without_it(learned: str) -> None:
    wave = waving(6.0)
    t_pose = np.array(wave[:1])
    for role, x in ((JointRole.LEFT_HAND, 0.8), (JointRole.RIGHT_HAND, -0.8)):
        t_pose[:, SUN_ROLES.index(role), 0] += x
    thrown = motion_of(np.concatenate([t_pose, wave]))
    shape = motion_shape(body_track(thrown)).astype(np.float64)
    others = motion_shape(body_track(motion_of(wave))).astype(np.float64)
    target = shape if learned == "of such takes" else others
    start, rest = fastest(target, *detail_of(thrown, shape, target))
    assert start < 1.2 * rest
    start, rest = fastest(shape, moments_of(body_track(thrown)), shape)
    assert start > 3 * rest  # as it was


def test_any_other_take_is_followed_whole() -> None:
    wave = motion_of(waving(6.0))
    shape = motion_shape(body_track(wave)).astype(np.float64)
    moments, led = detail_of(wave, shape, shape)
    np.testing.assert_array_equal(moments, moments_of(body_track(wave)))
    np.testing.assert_array_equal(led, shape)
