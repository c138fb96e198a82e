"""Transfers a course of 13 joint roles to the skeleton of a person.

1. The joints start with the mean rotations of the moments at which the person has the most similar
   poses. So twists, toes and fingers, which are not among the 13 roles, are those of the person.
2. The joints are rotated until the roles are at their positions (app.motion.posing). This is
   repeated with fixed positions of standing feet (app.motion.frame.foot_contact).
3. The feet are put on the floor (app.models.synthesis.feet).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from app.models.synthesis.feet import MIN_QUANTILE, feet_of, floor_of, on_the_floor, sole_depths
from app.models.synthesis.motion import Course
from app.motion.frame.body_frame import ANALYSIS_RATE, BodyTrack, turned
from app.motion.frame.foot_contact import FEET, planted
from app.motion.posing.inverse_kinematics import ancestors, pose_to
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation, continuous
from app.motion.skeleton.rotations import conjugate, identity_quaternions, multiply
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.euclidean import squared_distances

MAX_NEIGHBORS = 12
"""Largest number of moments of the person in the mean from which a pose starts."""

SMOOTHING = 1.5
"""Standard deviation, in frames, of the smoothing of the start. It is needed because the nearest
moments change from frame to frame."""

_HIPS = SUN_ROLES.index(JointRole.HIPS)


@dataclass(frozen=True, slots=True)
class Donor:
    """A real clip of the person at ANALYSIS_RATE: rotations and positions of the joints, the
    body's track over the same frames, and the joint of each role."""

    animation: Animation
    track: BodyTrack
    joints: dict[JointRole, int]


def same_body(donors: Sequence[Donor]) -> list[Donor]:
    """The donors with the same rest skeleton as the first donor, in the given order."""
    first = donors[0].animation.skeleton
    return [
        donor
        for donor in donors
        if donor.animation.skeleton.names == first.names
        and np.allclose(donor.animation.skeleton.offsets, first.offsets, atol=0.02)
    ]


def embody(course: Course, donors: Sequence[Donor]) -> Animation:
    """The course as an animation of the skeleton that the donors share; the floor is at Y = 0.

    donors: at least one, all of the same body (see `same_body`).
    """
    joints = donors[0].joints
    posed = pose_to(_start(course, donors), joints, course.positions)
    targets = np.array(course.positions)
    reached = posed.positions()
    feet = [SUN_ROLES[foot] for foot in FEET]
    if all(role in joints for role in feet):
        ankles = reached[:, [joints[role] for role in feet]]
        targets[:, FEET] = planted(ankles, ANALYSIS_RATE)
        posed = pose_to(posed, joints, targets)
        reached = posed.positions()
        soles = feet_of(posed.skeleton, [joints[role] for role in feet])
        if soles:
            depths = sole_depths(soles, [donor.animation.positions() for donor in donors])
            return on_the_floor(_lowered(posed, floor_of(reached, soles, depths)), soles)
    return _lowered(posed, float(np.quantile(reached[:, :, 1].min(axis=1), MIN_QUANTILE)))


def _lowered(posed: Animation, floor: float) -> Animation:
    """The animation moved down by `floor` meters."""
    translations = np.array(posed.translations)
    translations[:, 0, 1] -= floor
    return Animation(posed.skeleton, posed.rotations, translations, ANALYSIS_RATE)


def _start(course: Course, donors: Sequence[Donor]) -> Animation:
    """An animation near the course, by which `pose_to` begins.

    Each frame is the weighted mean of the donors' frames with the most similar poses. The root
    follows the course.
    """
    local = np.concatenate([donor.track.local for donor in donors])
    turns = np.concatenate([_toward_heading(donor) for donor in donors])
    offsets = np.concatenate([donor.animation.translations for donor in donors])
    near, weights = _nearest_poses(_poses(course), local)
    rotations = _mean_turns(turns[near], weights)
    translations = np.einsum("nk,nkjc->njc", weights, offsets[near])
    skeleton, hips = donors[0].animation.skeleton, donors[0].joints[JointRole.HIPS]
    rotations[:, hips] = multiply(_about_y(course.heading), rotations[:, hips])
    translations[:, hips] = course.positions[:, _HIPS]
    above = ancestors(skeleton, hips)
    if above:  # a root on the floor follows the hips
        rotations[:, above] = identity_quaternions((1, 1))
        translations[:, above] = 0.0
        translations[:, 0] = course.positions[:, _HIPS] * [1.0, 0.0, 1.0]
        translations[:, hips] *= [0.0, 1.0, 0.0]
    return Animation(skeleton, rotations, translations, ANALYSIS_RATE)


def _poses(course: Course) -> FloatArray:
    """(n, 13, 3) meters, the poses relative to the hips and to the heading."""
    return turned(course.positions - course.positions[:, [_HIPS]], -course.heading)


def _nearest_poses(poses: FloatArray, others: FloatArray) -> tuple[IntArray, FloatArray]:
    """The k of `others` (m, 13, 3) that are most similar to each of `poses` (n, 13, 3).

    `poses` are scaled to the mean size of `others`, so the units may differ. Returns the rows
    (n, k) of the similar poses, and their weights (n, k), which sum to 1 for each pose.
    """
    rows, table = (values.reshape(len(values), -1) for values in (poses, others))
    rows = rows * (np.linalg.norm(table) / len(table) ** 0.5)
    rows /= max(np.linalg.norm(poses) / len(poses) ** 0.5, 1e-9)
    squares = squared_distances(rows, table)
    count = min(MAX_NEIGHBORS, len(table))
    near = np.argsort(squares, axis=1, kind="stable")[:, :count]
    chosen = np.take_along_axis(squares, near, axis=1)
    weights = np.exp(-0.5 * chosen / np.maximum(chosen.mean(axis=1, keepdims=True), 1e-9))
    return near, weights / weights.sum(axis=1, keepdims=True)


def _mean_turns(turns: FloatArray, weights: FloatArray) -> FloatArray:
    """(n, joints, 4) weighted means of quaternions (n, k, joints, 4), smoothed over time."""
    # q and -q are the same rotation: all get the sign of the first before the mean
    sign = np.sign(np.einsum("nkjc,njc->nkj", turns, turns[:, 0]))
    mean = np.einsum("nk,nkj,nkjc->njc", weights, np.where(sign == 0, 1.0, sign), turns)
    lengths = np.maximum(np.linalg.norm(mean, axis=-1, keepdims=True), 1e-9)
    smooth = scipy.ndimage.gaussian_filter1d(
        continuous(mean / lengths), SMOOTHING, axis=0, mode="nearest"
    )
    return np.asarray(smooth / np.maximum(np.linalg.norm(smooth, axis=-1, keepdims=True), 1e-9))


def _toward_heading(donor: Donor) -> FloatArray:
    """(n, joints, 4) the donor's rotations; those of the hips are relative to the heading."""
    rotations = np.array(donor.animation.rotations, dtype=np.float64)
    hips = donor.joints[JointRole.HIPS]
    turn: FloatArray = rotations[:, hips]
    for joint in ancestors(donor.animation.skeleton, hips):
        turn = multiply(rotations[:, joint], turn)
    rotations[:, hips] = multiply(conjugate(_about_y(donor.track.heading)), turn)
    return rotations


def _about_y(angles: FloatArray) -> FloatArray:
    """(n, 4) rotations about Y by angles (n,), radians."""
    zeros = np.zeros_like(angles)
    return np.stack([np.cos(angles / 2), zeros, np.sin(angles / 2), zeros], axis=-1)
