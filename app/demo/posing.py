"""Converts controls to joint rotations. Legs need two-link inverse kinematics.

Matrices (frames, 3, 3) map the rest frame of a joint to the world. Lengths are in meters.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.demo.controls import Arm, Controls, Foot, Turn
from app.demo.curves import softened
from app.demo.rig import (
    CLAVICLE,
    FOOT,
    FOREARM,
    HAND,
    HEAD,
    HIPS,
    NECK,
    PARENTS,
    SHIN,
    SIDES,
    SIGNS,
    SPINE,
    SPINE1,
    SPINE2,
    THIGH,
    TOES,
    UPPER_ARM,
    Rig,
)
from app.motion.skeleton.rotations import matrices_to_quaternions
from app.numerics.arrays import FloatArray

MAX_LEG_EXTENSION = 0.994
"""The largest distance of hip and ankle, as a share of the leg's length. A knee always bends."""
ROLL_PITCHES = np.radians([-4.0, -2.0, 0.0, 2.0, 4.0])
"""Shifts of the pitch over which the pivot of the foot changes from the heel to the ball."""


def local_rotations(controls: Controls, rig: Rig) -> FloatArray:
    """(frames, 22, 4) the local unit quaternions (w, x, y, z) of the joints."""
    world = _world_rotations(controls, rig)
    local = world.copy()
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            local[:, joint] = np.swapaxes(world[:, parent], -1, -2) @ world[:, joint]
    return matrices_to_quaternions(local)


def lowered_to_reach(
    controls: Controls, rig: Rig, times: FloatArray, calm: float = 0.08
) -> Controls:
    """`controls` with the pelvis lowered smoothly at the times when a leg does not reach its foot.

    times: (frames,) s. calm: seconds of smoothing.
    """
    excess = np.maximum(controls.root[:, 1] - max_root_height(controls, rig), 0.0)
    lowered = softened(_running_maximum(excess, times, 2.0 * calm), times, calm)
    return replace(controls, root=controls.root - lowered[:, None] * [0.0, 1.0, 0.0])


def _running_maximum(curve: FloatArray, times: FloatArray, seconds: float) -> FloatArray:
    """(frames,) the maximum within `seconds` of each frame. So later smoothing cuts no peak."""
    reach = round(seconds / float(times[1] - times[0]))
    padded = np.pad(curve, reach)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1)
    return np.asarray(windows.max(axis=-1))


def max_root_height(controls: Controls, rig: Rig, reach: float = MAX_LEG_EXTENSION) -> FloatArray:
    """(frames,) the largest height of the pelvis, in meters, at which both legs reach their feet.

    reach: the largest distance of hip and ankle, as a share of the leg's length.
    """
    pelvis = _matrices(controls.pelvis)
    limits = []
    for side in SIDES:
        hip = pelvis @ _sided(rig.hip_offset, side)
        away = ankle_position(controls.feet[side], rig) - controls.root - hip
        flat = away[:, 0] ** 2 + away[:, 2] ** 2
        rise = np.sqrt(np.maximum((reach * rig.leg) ** 2 - flat, (0.3 * rig.leg) ** 2))
        limits.append(controls.root[:, 1] + away[:, 1] + rise)
    return np.asarray(np.minimum(*limits))


def ankle_position(foot: Foot, rig: Rig) -> FloatArray:
    """(frames, 3) the position of the ankle in the world, meters."""
    # The mean over a few degrees: without it, the ankle would jump when the pivot changes.
    ankles = [_ankle_over_sole(foot.pitch + shift, rig) for shift in ROLL_PITCHES]
    forward, height = np.mean(ankles, axis=0)
    offset = [np.sin(foot.yaw) * forward, height, np.cos(foot.yaw) * forward]
    return np.asarray(foot.position + np.stack(offset, axis=-1))


def _ankle_over_sole(pitch: FloatArray, rig: Rig) -> FloatArray:
    """(2, frames) forward position and height of the ankle above the sole's lowest point."""
    heel_up = pitch < 0.0
    pivot_height = np.where(heel_up, rig.ball_height, 0.0)
    pivot_ahead = np.where(heel_up, rig.ball, -rig.heel)
    up, ahead = rig.ankle - pivot_height, -pivot_ahead
    c, s = np.cos(pitch), np.sin(pitch)  # the vector from pivot to ankle is rotated by pitch
    return np.array([pivot_ahead + ahead * c - up * s, pivot_height + up * c + ahead * s])


def _world_rotations(controls: Controls, rig: Rig) -> FloatArray:
    world = np.zeros((controls.frames, len(PARENTS), 3, 3))
    world[:, HIPS] = _matrices(controls.pelvis)
    for joint in (SPINE, SPINE1, SPINE2):
        world[:, joint] = world[:, joint - 1] @ _matrices(_scaled_turn(controls.spine, 1 / 3))
    half = _matrices(_scaled_turn(controls.head, 1 / 2))
    world[:, NECK] = world[:, SPINE2] @ half
    world[:, HEAD] = world[:, NECK] @ half
    for side in SIDES:
        _pose_arm(world, controls, rig, side)
        _pose_leg(world, controls, rig, side)
    return world


def _pose_arm(world: FloatArray, controls: Controls, rig: Rig, side: int) -> None:
    arm, sign, chest = controls.arms[side], SIGNS[side], world[:, SPINE2]
    hang = about_z(np.array([-sign * (np.pi / 2 - rig.arm_drop)]))
    upper = chest @ _shoulder(arm, sign)
    fore = upper @ about_x(-arm.elbow)
    world[:, CLAVICLE[side]] = chest @ about_z(sign * (controls.shrug + _shoulder_rise(arm)))
    world[:, UPPER_ARM[side]] = upper @ hang
    world[:, FOREARM[side]] = fore @ hang
    world[:, HAND[side]] = fore @ about_x(-arm.wrist) @ hang


def _shoulder(arm: Arm, sign: float) -> FloatArray:
    lifted = about_x(-arm.flex) @ about_z(sign * arm.abduct)
    return np.asarray(lifted @ about_y(-sign * arm.twist))


def _shoulder_rise(arm: Arm) -> FloatArray:
    """(frames,) the rise of the clavicle: a quarter of the arm's elevation above 40 degrees."""
    elevation = np.arccos(np.clip(np.cos(arm.flex) * np.cos(arm.abduct), -1.0, 1.0))
    # a smooth maximum of 0 and the elevation above 0.7 rad
    return np.asarray(0.25 * np.logaddexp(0.0, 6.0 * (elevation - 0.7)) / 6.0)


def _pose_leg(world: FloatArray, controls: Controls, rig: Rig, side: int) -> None:
    foot, pelvis = controls.feet[side], world[:, HIPS]
    away = ankle_position(foot, rig) - controls.root - pelvis @ _sided(rig.hip_offset, side)
    knee_out = about_y(0.5 * (foot.yaw + controls.pelvis.yaw))[:, :, 0]
    world[:, THIGH[side]], world[:, SHIN[side]] = _two_links(away, knee_out, rig)
    yaw = about_y(foot.yaw)
    world[:, FOOT[side]] = yaw @ about_x(-foot.pitch)
    world[:, TOES[side]] = yaw @ about_x(-_toe_pitch(foot, rig))


def _toe_pitch(foot: Foot, rig: Rig) -> FloatArray:
    """(frames,) the pitch of the toes. They are bent up if they would enter the floor."""
    room = np.clip((foot.position[:, 1] + 0.5 * rig.ball_height) / rig.toes, 0.0, 1.0)
    return np.asarray(np.maximum(foot.pitch, -np.arcsin(room)))


def _two_links(away: FloatArray, hinge: FloatArray, rig: Rig) -> tuple[FloatArray, FloatArray]:
    """World rotations of thigh and shin, by the law of cosines.

    away: (frames, 3) from the hip joint to the ankle. hinge: (frames, 3) the axis about which the
    knee bends; its part along the leg is removed.
    """
    length = np.linalg.norm(away, axis=-1)
    reach = np.clip(length, 0.35 * rig.leg, 0.9999 * rig.leg)
    axis = away / np.maximum(length, 1e-9)[:, None]
    hinge = hinge - np.sum(hinge * axis, axis=-1, keepdims=True) * axis
    hinge /= np.linalg.norm(hinge, axis=-1, keepdims=True)
    frame = np.stack([hinge, -axis, np.cross(hinge, -axis)], axis=-1)
    a, b = rig.thigh, rig.shin
    at_hip = np.arccos(np.clip((a * a + reach**2 - b * b) / (2.0 * a * reach), -1.0, 1.0))
    at_ankle = np.arccos(np.clip((b * b + reach**2 - a * a) / (2.0 * b * reach), -1.0, 1.0))
    return frame @ about_x(-at_hip), frame @ about_x(at_ankle)


def _sided(offset: FloatArray, side: int) -> FloatArray:
    return np.asarray(offset * np.array([SIGNS[side], 1.0, 1.0]))


def _scaled_turn(turn: Turn, share: float) -> Turn:
    return Turn(turn.yaw * share, turn.pitch * share, turn.roll * share)


def _matrices(turn: Turn) -> FloatArray:
    return np.asarray(about_y(turn.yaw) @ about_x(turn.pitch) @ about_z(turn.roll))


def about_x(angle: FloatArray) -> FloatArray:
    """(frames, 3, 3) rotations about X."""
    return _about(angle, 1, 2)


def about_y(angle: FloatArray) -> FloatArray:
    """(frames, 3, 3) rotations about Y."""
    return _about(angle, 2, 0)


def about_z(angle: FloatArray) -> FloatArray:
    """(frames, 3, 3) rotations about Z."""
    return _about(angle, 0, 1)


def _about(angle: FloatArray, first: int, second: int) -> FloatArray:
    """Rotations that turn axis `first` toward axis `second`."""
    matrices = np.zeros((len(angle), 3, 3))
    third = 3 - first - second
    matrices[:, third, third] = 1.0
    matrices[:, first, first] = matrices[:, second, second] = np.cos(angle)
    matrices[:, second, first] = np.sin(angle)
    matrices[:, first, second] = -np.sin(angle)
    return matrices
