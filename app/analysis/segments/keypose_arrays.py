"""What is kept of a clip's keyposes: the frames, and the segments between them.

In one place, since keyposes change without the motion: when a person names them, and when
beats or thresholds become known.
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

    frames: (k,) rising; features_10hz: (m, 82).
    """
    segments = describe_segments(features_10hz, frames / ANALYSIS_RATE)
    return {"keypose_frames": frames.astype(np.int32), **segments}


def frames_at(times: FloatArray, frames: int) -> IntArray:
    """(k,) frames nearest to `times` (seconds), rising, each once, of a clip of `frames`."""
    nearest = np.round(np.asarray(times, dtype=np.float64) * ANALYSIS_RATE).astype(np.int64)
    return np.unique(nearest[(nearest >= 0) & (nearest < frames)])
