"""What else the world does to clips, beyond the disturbances from which the recognizer learns
(app.models.recognition.disturbances), as functions of a canonical motion."""

from __future__ import annotations

import numpy as np

from app.models.recognition.disturbances import Disturb, with_positions
from app.motion.motion import Motion


def without_first(frames: int) -> Disturb:
    """The clip without its first frames."""

    def disturb(motion: Motion, _: int) -> Motion:
        return with_positions(motion, motion.positions[frames:])

    return disturb


def waiting(seconds: float) -> Disturb:
    """The person stands still in the first pose before the motion."""

    def disturb(motion: Motion, _: int) -> Motion:
        still = np.repeat(motion.positions[:1], round(seconds * motion.frame_rate), axis=0)
        return with_positions(motion, np.concatenate([still, motion.positions]))

    return disturb


def repeated(motion: Motion, _: int) -> Motion:
    """Twice in a row, the second time from where the first one ended."""
    root = int(np.flatnonzero(motion.parents < 0)[0])
    step = motion.positions[-1, root] - motion.positions[0, root]
    step[1] = 0.0
    return with_positions(motion, np.concatenate([motion.positions, motion.positions + step]))
