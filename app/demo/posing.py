"""From controls to joint rotations: legs by two-link inverse kinematics, the rest direct.

Matrices are (frames, 3, 3), mapping a joint's rest frame to the world; meters.
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

STRAIGHTEST = 0.994
"""The most of a leg's length that hip and ankle may be apart: knees are never locked."""
ROLLING = np.radians([-4.0, -2.0, 0.0, 2.0, 4.0])
"""Over these pitches the foot's turning passes from the heel to the ball."""


def local_rotations(controls: Controls, rig: Rig) -> FloatArray:
    """(frames, 22, 4) local unit quaternions w x y z of a performance."""
    world = _world_rotations(controls, rig)
    local = world.copy()
    for joint, parent in enumerate(PARENTS):
        if parent >= 0:
            local[:, joint] = np.swapaxes(world[:, parent], -1, -2) @ world[:, joint]
    return matrices_to_quaternions(local)


def within_reach(controls: Controls, rig: Rig, times: FloatArray, calm: float = 0.08) -> Controls:
    """The same, the pelvis lowered smoothly (over `calm` s) where a leg would not reach."""
    excess = np.maximum(controls.root[:, 1] - highest_root(controls, rig), 0.0)
    lowered = softened(_widened(excess, times, 2.0 * calm), times, calm)
    return replace(controls, root=controls.root - lowered[:, None] * [0.0, 1.0, 0.0])


def _widened(curve: FloatArray, times: FloatArray, seconds: float) -> FloatArray:
    """Running maximum over `seconds` to either side, so that smoothing does not cut peaks."""
    reach = round(seconds / float(times[1] - times[0]))
    padded = np.pad(curve, reach)
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1)
    return np.asarray(windows.max(axis=-1))


def highest_root(controls: Controls, rig: Rig, reach: float = STRAIGHTEST) -> FloatArray:
    """(frames,) greatest height of the pelvis at which both legs reach their feet.

    reach: the most of a leg's length that hip and ankle may be apart.
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
    """(frames, 3) world position of the ankle, the foot turning about its ball or its heel."""
    # Averaged over a few degrees: the change of pivot at a flat foot would jolt the ankle.
    spread = [_ankle_over_sole(foot.pitch + shift, rig) for shift in ROLLING]
    forward, height = np.mean(spread, axis=0)
    offset = [np.sin(foot.yaw) * forward, height, np.cos(foot.yaw) * forward]
    return np.asarray(foot.place + np.stack(offset, axis=-1))


def _ankle_over_sole(pitch: FloatArray, rig: Rig) -> FloatArray:
    """(2, frames) forward position and height of the ankle, the sole's lowest point at 0."""
    heel_up = pitch < 0.0
    pivot_height = np.where(heel_up, rig.ball_height, 0.0)
    pivot_ahead = np.where(heel_up, rig.ball, -rig.heel)
    up, ahead = rig.ankle - pivot_height, -pivot_ahead
    c, s = np.cos(pitch), np.sin(pitch)
    return np.array([pivot_ahead + ahead * c - up * s, pivot_height + up * c + ahead * s])


def _world_rotations(controls: Controls, rig: Rig) -> FloatArray:
    world = np.zeros((controls.frames, len(PARENTS), 3, 3))
    world[:, HIPS] = _matrices(controls.pelvis)
    for joint in (SPINE, SPINE1, SPINE2):
        world[:, joint] = world[:, joint - 1] @ _matrices(_third(controls.spine, 1 / 3))
    half = _matrices(_third(controls.head, 1 / 2))
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
    """(frames,) rise of the clavicle with the arm: a quarter of the elevation beyond 40 deg."""
    elevation = np.arccos(np.clip(np.cos(arm.flex) * np.cos(arm.abduct), -1.0, 1.0))
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
    """(frames,) pitch of the toes: never deeper than the clearance of the sole allows."""
    room = np.clip((foot.place[:, 1] + 0.5 * rig.ball_height) / rig.toes, 0.0, 1.0)
    return np.asarray(np.maximum(foot.pitch, -np.arcsin(room)))


def _two_links(away: FloatArray, hinge: FloatArray, rig: Rig) -> tuple[FloatArray, FloatArray]:
    """World rotations of thigh and shin, so that the ankle stands `away` from the hip joint.

    hinge: (frames, 3) axis about which the knee bends, made square to the leg.
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


def _third(turn: Turn, share: float) -> Turn:
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
