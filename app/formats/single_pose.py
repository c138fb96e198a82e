"""Makes a short motion of a file that has a single frame, so that it can be found as a pose."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from app.motion.skeleton.recording import Caution, Recording
from app.numerics.arrays import FloatArray

MIN_SECONDS, MIN_FRAMES = 0.1, 10
"""How long the pose is held, at least. An analysis needs two frames at 30 Hz, also if a client
sends a higher frame rate."""
USUAL_RATE = 30.0
"""Hz: the rate of a pose whose file gives none. A pose that does not move is the same at any."""


def with_held_pose(recording: Recording) -> Recording:
    """The recording; one of a single frame with this frame repeated, and a caution."""
    if len(recording.positions) != 1:
        return recording
    rate = recording.frame_rate or recording.assumed_frame_rate or USUAL_RATE
    frames = max(MIN_FRAMES, math.ceil(MIN_SECONDS * rate))
    detail = f"the file has one frame; it is kept as a pose that is held for {frames} frames"
    return replace(
        recording,
        positions=_repeated(recording.positions, frames),
        rotations=_if_there(recording.rotations, frames),
        translations=_if_there(recording.translations, frames),
        frame_rate=rate,
        cautions=(*recording.cautions, Caution("single_pose", detail)),
    )


def _repeated(array: FloatArray, frames: int) -> FloatArray:
    return np.repeat(array, frames, axis=0)


def _if_there(array: FloatArray | None, frames: int) -> FloatArray | None:
    return None if array is None else _repeated(array, frames)
