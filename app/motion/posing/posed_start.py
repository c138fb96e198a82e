"""Files that begin with a pose that is no part of the motion: CMU's have the T-pose of their
skeleton as first frame, from which the body is thrown into the motion."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from app.motion.motion import Motion

THROWN = 2.0
"""Times the longest step of a joint role between any other two frames. Of 42 real clips by CMU
all but one begin with more, of 97 by Bandai-Namco none with more than 1.05."""

MIN_FRAMES = 10
"""The fewest frames. With fewer, the first step cannot be compared with the others."""


def without_posed_start(motion: Motion) -> Motion:
    """The motion without its first frame where that is such a pose, else the same object."""
    if motion.frames < MIN_FRAMES:
        return motion
    roles = motion.role_positions().astype(np.float64)
    steps = np.linalg.norm(np.diff(roles, axis=0), axis=-1).max(axis=1)
    if steps[0] <= THROWN * steps[1:].max() or steps[1:].max() <= 0:
        return motion
    return replace(motion, positions=motion.positions[1:])
