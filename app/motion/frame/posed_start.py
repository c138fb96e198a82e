"""Finds a pose at the start that does not belong to the motion.

The first frame of CMU's files is the T-pose of their skeleton. The motion starts in the second
frame, at a distant pose. Other programs hold such a pose for some frames. No analysis may read it:
in a short clip, a frame of T-pose changes the covariance of the joints more than the style does.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.motion.motion import Motion

MIN_JUMP_RATIO = 2.0
"""The step from the pose to the motion is longer than the longest other step by this factor. The
start is found in 41 of 42 real BVH clips by CMU, in 5 of 7 of another conversion, and in none of
447 by Bandai-Namco, which have no such pose."""

MIN_FRAMES = 10
"""The fewest frames. With fewer, the first step cannot be compared with the others."""

MAX_POSED_SECONDS = 2.0
"""A pose that is held for longer is a part of the motion."""

MAX_SWAY = 1e-3
"""Meters between two frames of a held pose: rounding in a file, but no living person."""


def posed_frames(motion: Motion) -> int:
    """How many frames at the start are a pose that does not belong to the motion; 0 if none."""
    if motion.frames < MIN_FRAMES:
        return 0
    roles = motion.role_positions().astype(np.float64)
    # (frames - 1,) the longest way of a joint from each frame to the next
    steps = np.linalg.norm(np.diff(roles, axis=0), axis=-1).max(axis=1)
    jump = int(np.argmax(steps))
    longest = max(steps[:jump].max(initial=0.0), steps[jump + 1 :].max(initial=0.0))
    is_jump = steps[jump] > MIN_JUMP_RATIO * longest and longest > 0
    is_held = bool((steps[:jump] <= MAX_SWAY).all())
    is_short = jump + 1 <= min(MAX_POSED_SECONDS * motion.frame_rate, motion.frames / 2)
    return jump + 1 if is_jump and is_held and is_short else 0


def without_posed_start(motion: Motion) -> Motion:
    """The motion without such a pose; the same object if there is none."""
    posed = posed_frames(motion)
    return replace(motion, positions=motion.positions[posed:]) if posed else motion


def with_held_start(motion: Motion) -> Motion:
    """The motion with its first real pose instead of such a pose, so that all times stay as they
    are; the same object if there is none."""
    posed = posed_frames(motion)
    if not posed:
        return motion
    held = motion.positions.copy()
    held[:posed] = held[posed]
    return replace(motion, positions=held)
