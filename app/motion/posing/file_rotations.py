"""Converts the rotations of a file to the canonical form of its motion: meters, Y up.

A canonical motion is the recording, turned to Y up and scaled to meters. The turn is found by
comparing the recording with the stored positions. So a file that is read differently now than when
it was stored is detected, and is not exported wrongly.
"""

from __future__ import annotations

import numpy as np

from app.motion.canonical.up_axis import to_y_up
from app.motion.motion import Motion
from app.motion.skeleton.animation import Animation, animation_of_rotations
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import conjugate, matrices_to_quaternions, multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

MAX_OFFSET_ERROR = 5e-5
"""Meters: the largest distance between the stored positions and those by the offsets of the file.
If it is larger, translations replace the offsets."""
MAX_READING_ERROR = 1e-3
"""Meters: the largest distance, in the first frame, between the recording and the stored motion."""
UP_AXES = ("y", "z", "x", "-z", "-x", "-y")


def animation_of_recording(recording: Recording, motion: Motion) -> Animation | None:
    """An animation with the rotations of a recording, in the canonical form of `motion`.

    motion: the canonical motion of the recording. The result is in meters, Y up, and has the
    positions of `motion`, apart from rounding. It is None if the recording has no rotations, or if
    `motion` was not made from it.
    """
    if recording.rotations is None or recording.skeleton.names != motion.names:
        return None
    turn = _turn_between(recording, motion)
    if turn is None or recording.rotations.shape[:2] != motion.positions.shape[:2]:
        return None
    local = recording.rotations.astype(np.float64)
    local /= np.linalg.norm(local, axis=-1, keepdims=True)  # float32 is not exactly unit length
    rotations = multiply(multiply(turn, local), conjugate(turn))
    skeleton = _turned(recording.skeleton, turn, motion.metres_per_unit)
    translations = _translations(recording, turn, motion)
    reached = forward_kinematics(skeleton, rotations, translations)
    if np.abs(reached - motion.positions).max() <= MAX_OFFSET_ERROR:
        return Animation(skeleton, rotations, translations, motion.frame_rate)
    return animation_of_rotations(skeleton, rotations, motion.positions, motion.frame_rate)


def _turn_between(recording: Recording, motion: Motion) -> FloatArray | None:
    """(4,) the quaternion that turns the recording's first frame to the stored one, or None."""
    if recording.positions.shape != motion.positions.shape:
        return None
    first = recording.positions[0].astype(np.float64) * motion.metres_per_unit
    for axis in UP_AXES:
        if np.abs(to_y_up(first, axis) - motion.positions[0]).max() <= MAX_READING_ERROR:
            return matrices_to_quaternions(to_y_up(np.eye(3), axis).T)
    return None


def _turned(skeleton: Skeleton, turn: FloatArray, scale: float) -> Skeleton:
    """The skeleton with turned offsets in meters.

    Local rotations are conjugated by `turn`, so the rest pose must be turned in the same way.
    """
    return Skeleton(
        names=skeleton.names,
        parents=skeleton.parents,
        offsets=rotate(turn, skeleton.offsets) * scale,
        end_parents=skeleton.end_parents,
        end_offsets=rotate(turn, skeleton.end_offsets) * scale,
    )


def _translations(recording: Recording, turn: FloatArray, motion: Motion) -> FloatArray:
    """(frames, joints, 3) local translations, meters, in the turned frame."""
    local = recording.translations
    if local is None:
        local = local_translations(recording.skeleton, recording.positions[:, 0])
    translations = rotate(turn, local.astype(np.float64)) * motion.metres_per_unit
    roots = recording.skeleton.parents < 0
    # A root has no parent, so its translation is its stored position.
    translations[:, roots] = motion.positions[:, roots]
    return translations
