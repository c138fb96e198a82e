"""Inverse kinematics: poses of a skeleton whose joint roles are at given targets.

The method is damped Gauss-Newton on the rotations of joints, for all frames at once. Joints above a
role turn so that the role comes near its target. They stay near the pose from which they start,
which decides what the targets do not determine (twists, fingers, toes).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.kinematics import forward_kinematics, joints_by_depth
from app.motion.skeleton.rotations import conjugate, multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

MAX_ITERATIONS = 12
DAMPING = 3e-3
"""Square meters per square radian: the damping of a step."""

START_WEIGHT = 1e-3
"""Square meters per square radian: the cost of turning a joint away from its start."""

MAX_STEP = 0.4
"""Radians: the largest turn of a joint in one step."""

MIN_STEP = 2e-3
"""Radians and meters: if all steps are smaller, the iteration ends."""

_WEIGHTS = {
    JointRole.HIPS: 2.0,
    JointRole.LEFT_FOOT: 3.0,
    JointRole.RIGHT_FOOT: 3.0,
    JointRole.LEFT_SHOULDER: 1.5,
    JointRole.RIGHT_SHOULDER: 1.5,
    JointRole.LEFT_KNEE: 0.7,
    JointRole.RIGHT_KNEE: 0.7,
}
"""The weights of joint roles; other roles have weight 1. Feet must not slide, and the shoulders
show the heading of the body. Targets of knees are less exact, because proportions differ."""


@dataclass(frozen=True, slots=True)
class _Body:
    """A skeleton prepared for inverse kinematics.

    turning: (t,) the joints that may turn. targeted: (w,) the joints that have a target. weights:
    (w,) the weight of each target. moves: (w, t) 1 if the turn of a joint moves a target, else 0.
    """

    turning: IntArray
    targeted: IntArray
    weights: FloatArray
    moves: FloatArray


def pose_to(start: Animation, joints: dict[JointRole, int], targets: FloatArray) -> Animation:
    """The poses near `start` whose roles are nearest to their targets (least squares).

    start: an animation with as many frames as `targets`. joints: the joint of each role. targets:
    (frames, 13, 3) in the world, meters, Y up, in SUN_ROLES order; targets of roles without a joint
    are ignored. Only the translation of the first root, and the rotations of the hips and of joints
    below them, are changed.
    """
    body = _body(start.skeleton, joints)
    columns = [SUN_ROLES.index(role) for role in SUN_ROLES if role in joints]
    aim = np.asarray(targets, dtype=np.float64)[:, columns]
    rotations = np.array(start.rotations, dtype=np.float64)
    translations = np.array(start.translations, dtype=np.float64)
    total_turns = np.zeros((len(aim), 3 * len(body.turning)))
    for _ in range(MAX_ITERATIONS):
        positions, above = _world(start.skeleton, rotations, translations)
        step = _step(body, positions, aim, total_turns)
        translations[:, 0] += step[:, :3]
        turns = step[:, 3:]
        total_turns += turns
        _turn(rotations, above, body.turning, turns.reshape(len(aim), -1, 3))
        if np.abs(step).max() < MIN_STEP:
            break
    return Animation(start.skeleton, rotations, translations, start.frame_rate)


def ancestors(skeleton: Skeleton, joint: int) -> list[int]:
    """The joints above a joint, from its parent to its root."""
    found = []
    parent = int(skeleton.parents[joint])
    while parent >= 0:
        found.append(parent)
        parent = int(skeleton.parents[parent])
    return found


def _body(skeleton: Skeleton, joints: dict[JointRole, int]) -> _Body:
    roles = [role for role in SUN_ROLES if role in joints]
    targeted = np.array([joints[role] for role in roles])
    below = np.zeros((len(skeleton), len(roles)))
    for column, joint in enumerate(targeted):
        below[ancestors(skeleton, joint), column] = 1.0
    # Joints above the hips do not turn, because they would turn the whole world.
    below[ancestors(skeleton, joints[JointRole.HIPS])] = 0.0
    turning = np.flatnonzero(below.sum(axis=1))
    weights = np.array([_WEIGHTS.get(role, 1.0) for role in roles])
    return _Body(turning, targeted, weights, below[turning].T)


def _world(
    skeleton: Skeleton, rotations: FloatArray, translations: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """World positions (frames, joints, 3), and world rotations of parents (frames, joints, 4)."""
    positions = forward_kinematics(skeleton, rotations, translations)
    world, above = np.array(rotations), np.zeros_like(rotations)
    above[..., 0] = 1.0
    for joints in joints_by_depth(skeleton.parents)[1:]:
        above[:, joints] = world[:, skeleton.parents[joints]]
        world[:, joints] = multiply(above[:, joints], world[:, joints])
    return positions, above


def _step(
    body: _Body, positions: FloatArray, aim: FloatArray, total_turns: FloatArray
) -> FloatArray:
    """(frames, 3 + 3 t) a damped Gauss-Newton step.

    It is a translation of the root in meters, then rotation vectors of the joints in the world, in
    radians. positions: (frames, joints, 3). aim: (frames, w, 3) the targets. total_turns: (frames,
    3 t) the sum of the turns of earlier steps.
    """
    frames, count = len(aim), len(body.turning)
    errors = (aim - positions[:, body.targeted]) * body.weights[:, None]
    # arms (frames, w, t, 3): from each joint that turns to each target that it moves
    arms = positions[:, body.targeted][:, :, None] - positions[:, body.turning][:, None]
    arms = arms * (body.moves * body.weights[:, None])[:, :, None]
    # slope (frames, w, 3, 3 + 3 t): the derivatives of the targets' positions
    slope = np.zeros((frames, len(body.targeted), 3, 3 + 3 * count))
    slope[:, :, [0, 1, 2], [0, 1, 2]] = body.weights[:, None]
    # A small turn moves a target by the cross product turn x arm.
    crossed = np.zeros((frames, len(body.targeted), 3, count, 3))
    for a, b, c in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        crossed[:, :, a, :, b] = arms[..., c]
        crossed[:, :, a, :, c] = -arms[..., b]
    slope[..., 3:] = crossed.reshape(frames, len(body.targeted), 3, 3 * count)
    rows = slope.reshape(frames, -1, 3 + 3 * count)
    # The normal equations: (J' J + damping) step = J' errors - the pull to the start.
    transposed = rows.transpose(0, 2, 1)
    normal = transposed @ rows
    damping = np.concatenate([np.zeros(3), np.full(3 * count, DAMPING + START_WEIGHT)])
    right = (transposed @ errors.reshape(frames, -1, 1))[..., 0]
    right[:, 3:] -= START_WEIGHT * total_turns
    # 1e-9 keeps the matrix invertible, because translations are not damped.
    step = np.linalg.solve(normal + np.diag(damping + 1e-9), right[..., None])[..., 0]
    step[:, 3:] = np.clip(step[:, 3:], -MAX_STEP, MAX_STEP)
    return np.asarray(step)


def _turn(rotations: FloatArray, above: FloatArray, joints: IntArray, turns: FloatArray) -> None:
    """Turn `joints` (t,) of `rotations` in place, by rotation vectors (frames, t, 3) of the world.

    above: (frames, joints, 4) the world rotations of parents.
    """
    parents = above[:, joints]
    seen = rotate(conjugate(parents), turns)
    angle = np.linalg.norm(seen, axis=-1, keepdims=True)
    half = 0.5 * angle
    axis = seen * (np.sinc(half / np.pi) * 0.5)
    delta = np.concatenate([np.cos(half), axis], axis=-1)
    turned = multiply(delta, rotations[:, joints])
    rotations[:, joints] = turned / np.linalg.norm(turned, axis=-1, keepdims=True)
