"""The rotations of a file in the canonical form, in which its positions are stored.

A canonical motion is the recording turned to Y up and scaled to meters. The turn is found again by
comparing the recording with the stored positions. So a file that is now read differently is
detected, and not exported wrongly.
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

SAME_PLACE = 5e-5
"""Meters: the largest distance between the positions by the file's own offsets and the stored
ones."""
SAME_READING = 1e-3
"""Meters: the largest distance, in the first frame, between the recording and what was stored."""
UP_AXES = ("y", "z", "x", "-z", "-x", "-y")


def animation_of_recording(recording: Recording, motion: Motion) -> Animation | None:
    """The rotations of a recording in the form of `motion`, which was made from it.

    The result is None if the recording has no rotations, or if `motion` was not made from it. Its
    positions are those of `motion`, apart from rounding.
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
    if np.abs(reached - motion.positions).max() <= SAME_PLACE:
        return Animation(skeleton, rotations, translations, motion.frame_rate)
    return animation_of_rotations(skeleton, rotations, motion.positions, motion.frame_rate)


def _turn_between(recording: Recording, motion: Motion) -> FloatArray | None:
    """(4,) the quaternion that turns the recording's first frame to the stored one, or None."""
    if recording.positions.shape != motion.positions.shape:
        return None
    first = recording.positions[0].astype(np.float64) * motion.metres_per_unit
    for axis in UP_AXES:
        if np.abs(to_y_up(first, axis) - motion.positions[0]).max() <= SAME_READING:
            return matrices_to_quaternions(to_y_up(np.eye(3), axis).T)
    return None


def _turned(skeleton: Skeleton, turn: FloatArray, scale: float) -> Skeleton:
    """Conjugating every local rotation turns the rest pose along with the world."""
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
    translations[:, roots] = motion.positions[:, roots]
    return translations
