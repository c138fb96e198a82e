"""Whether a frame rate is plausible for a human body."""

from __future__ import annotations

from app.motion.recording import Caution
from app.numerics.arrays import FloatArray


def judge_frame_rate(role_positions: FloatArray, rate: float) -> list[Caution]:
    """Cautions about a rate in Hz for role positions (frames, 13, 3), metres, Y up."""
    return []
