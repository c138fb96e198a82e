"""Removes a first frame that is a pose outside the motion.

The first frame of CMU's files is the T-pose of their skeleton. The motion starts in the second
frame, at a distant pose.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.motion.motion import Motion

MIN_JUMP_RATIO = 2.0
"""The first step is a jump if it is longer than the longest other step by this factor. Of 42 real
clips by CMU, all but one have a larger factor; of 97 by Bandai-Namco, none has more than 1.05."""

MIN_FRAMES = 10
"""The fewest frames. With fewer, the first step cannot be compared with the others."""


def without_posed_start(motion: Motion) -> Motion:
    """The motion without its first frame if the step after it is a jump, else the same object."""
    if motion.frames < MIN_FRAMES:
        return motion
    roles = motion.role_positions().astype(np.float64)
    steps = np.linalg.norm(np.diff(roles, axis=0), axis=-1).max(axis=1)
    if steps[0] <= MIN_JUMP_RATIO * steps[1:].max() or steps[1:].max() <= 0:
        return motion
    return replace(motion, positions=motion.positions[1:])
