"""The arrays that are stored for a clip's keyposes: their frames, and the segments between them.

This is one module, because keyposes can change while the motion does not: when a person corrects
them, and when beats or thresholds become known.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.segments.segments import describe_segments
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray, IntArray


def keypose_arrays(frames: IntArray, features_10hz: FloatArray) -> dict[str, NDArray[Any]]:
    """keypose_frames (k,) int32 at ANALYSIS_RATE, and the arrays of `describe_segments`.

    frames: (k,) the keyposes, rising. features_10hz: (m, 82) those of the clip.
    """
    segments = describe_segments(features_10hz, frames / ANALYSIS_RATE)
    return {"keypose_frames": frames.astype(np.int32), **segments}


def frames_at(times: FloatArray, frames: int) -> IntArray:
    """(k,) the frames at ANALYSIS_RATE nearest to `times` in seconds, rising, each once.

    frames: the length of the clip; times outside it are left out.
    """
    nearest = np.round(np.asarray(times, dtype=np.float64) * ANALYSIS_RATE).astype(np.int64)
    return np.unique(nearest[(nearest >= 0) & (nearest < frames)])
