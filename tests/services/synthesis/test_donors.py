from __future__ import annotations

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.descriptors.motion_shape import motion_shape
from app.models.synthesis.motion import course_of
from app.motion.frame.body_frame import smooth_track
from app.motion.posing.canonical_body import on_canonical_body
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray
from app.services.synthesis.donors import detail_of, donor_of
from tests.bodies import motion_of, waving


def fastest(target: FloatArray, take: FloatArray, take_shape: FloatArray) -> tuple[float, float]:
    """Largest movement of a joint role between two frames: the first two, and any others."""
    course = course_of(target, 1.5, take=take, take_shape=take_shape)
    steps = np.linalg.norm(np.diff(course.positions, axis=0), axis=-1).max(axis=1)
    return float(steps[:2].max()), float(steps[2:].max())


def test_a_take_that_begins_in_a_t_pose_is_followed_without_it() -> None:
    wave = waving(6.0)
    t_pose = np.array(wave[:1])
    for role, x in ((JointRole.LEFT_HAND, 0.8), (JointRole.RIGHT_HAND, -0.8)):
        t_pose[:, SUN_ROLES.index(role), 0] += x
    thrown = motion_of(np.concatenate([t_pose, wave]))
    shape = motion_shape(active_part(smooth_track(thrown))).astype(np.float64)
    start, rest = fastest(shape, detail_of(thrown), shape)
    assert start < 1.2 * rest


def test_a_take_is_followed_in_its_active_part() -> None:
    wave = waving(6.0)
    waits = motion_of(np.concatenate([np.repeat(wave[:1], 60, axis=0), wave]))
    assert len(detail_of(motion_of(wave))) == len(wave)
    assert len(wave) <= len(detail_of(waits)) <= len(wave) + 12


def test_a_donor_gives_no_pose_from_before_its_motion() -> None:
    wave = waving(3.0)
    thrown = motion_of(np.concatenate([np.repeat(wave[:1] + 0.5, 3, axis=0), wave]))
    donor = donor_of(thrown, on_canonical_body(thrown))
    assert donor.track.frames == len(wave)
    assert len(donor.animation.rotations) == len(wave)
