"""Windows: a motion in overlapping pieces of 1, 2 and 4 s, so that its parts are found (DESIGN 7).

A window's vector is what of the motion vector is cheap: how the body is held and travels
(means) and how much each feature moves (logarithms of variances: the diagonal of what the
motion vector takes whole). From running sums all windows of a second of motion cost some 0.05 ms,
where the eigendecompositions of their covariances would cost 6, and all other analysis 9.
It ranks a little worse (AP@5 of hidden pieces .71 for .80, `tests/bench/test_windows.py`), but
is only the first stage: what it proposes is warped onto the query frame by frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import FEATURES, TRAVEL, WARPING_RATE
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray, IntArray

POSITIONS = slice(0, 3 * len(SUN_ROLES))
"""The columns of the joints' positions in the frame features."""

LEVELS = np.r_[POSITIONS, TRAVEL]
"""Whose mean tells something; that of a joint's velocity is near 0 for all motions."""

WIDTH = len(LEVELS) + FEATURES
"""Numbers of a window vector: 125."""

RIDGE = 1e-3
"""Added to variances: the logarithm's floor for what stands still."""

VARIANCE_SCALE = 1 / 8
"""Brings the logarithms to the size of the means."""


@dataclass(frozen=True, slots=True)
class WindowScale:
    """Windows of one length. name: as in the arrays' names; frames, hop: at WARPING_RATE."""

    name: str
    frames: int
    hop: int

    @property
    def vectors(self) -> str:
        """The name of the array of vectors."""
        return f"window_vectors_{self.name}"

    @property
    def spans(self) -> str:
        """The name of the array of spans."""
        return f"window_spans_{self.name}"


WINDOW_SCALES = (WindowScale("1s", 10, 3), WindowScale("2s", 20, 5), WindowScale("4s", 40, 10))
"""From short to long. With hops of half a window, a piece between two of them is often missed."""


def window_arrays(features_10hz: FloatArray) -> dict[str, FloatArray]:
    """The arrays of all scales by name, of features (m, 82) at WARPING_RATE.

    window_vectors_*: (w, 125) float16; window_spans_*: (w, 2) float32 seconds.
    """
    arrays: dict[str, FloatArray] = {}
    sums = RunningSums(features_10hz)
    for scale in WINDOW_SCALES:
        frames = window_frames(len(features_10hz), scale)
        arrays[scale.vectors] = sums.vectors(frames)
        arrays[scale.spans] = (frames / WARPING_RATE).astype(np.float32)
    return arrays


def window_frames(count: int, scale: WindowScale) -> IntArray:
    """(w, 2) first frame and frame behind the last, of each window of `count` frames.

    The last window ends where the motion ends; a motion shorter than a window is one.
    """
    last = max(count - scale.frames, 0)
    firsts = np.arange(0, last + 1, scale.hop)
    if firsts[-1] < last:
        firsts = np.append(firsts, last)
    return np.stack([firsts, np.minimum(firsts + scale.frames, count)], axis=1)


class RunningSums:
    """Sums of frame features and of their squares up to each frame: any window in two reads."""

    def __init__(self, features: FloatArray) -> None:
        """`features`: (m, 82)."""
        self._sums = _running(features)
        self._squares = _running(np.square(features, dtype=np.float64))

    def vectors(self, frames: IntArray) -> FloatArray:
        """(w, 125) float16 window vectors of `frames` (w, 2), as from `window_frames`."""
        first, stop = frames.T
        counts = (stop - first)[:, None]
        means = (self._sums[stop] - self._sums[first]) / counts
        variances = (self._squares[stop] - self._squares[first]) / counts - means**2
        # below 0 only by rounding
        logarithms = np.log(np.maximum(variances, 0.0) + RIDGE) * VARIANCE_SCALE
        return np.hstack([means[:, LEVELS], logarithms]).astype(np.float16)


def _running(values: FloatArray) -> FloatArray:
    """(m + 1, d) float64 sums of the rows before each row of `values` (m, d)."""
    sums = np.zeros((len(values) + 1, values.shape[1]))
    np.cumsum(values, axis=0, dtype=np.float64, out=sums[1:])
    return sums
