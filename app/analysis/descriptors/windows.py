"""Windows: a motion in overlapping pieces of 1, 2 and 4 s, so that parts of it can be found.

The vector of a window holds the cheap parts of the motion vector: how the body is held and travels
(means), and how much each feature varies (logarithms of variances, without covariances). With
running sums, all windows of a second of motion take 0.05 ms; eigendecompositions of covariances
would take 6 ms, and the rest of the analysis takes 9 ms. The ranking is a little worse (AP@5 of
hidden pieces .71 instead of .80, `tests/bench/test_windows.py`). But this is only the first stage
of a search: the proposed windows are then warped onto the query frame by frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import FEATURES, TRAVEL, WARPING_RATE
from app.motion.roles.joint_roles import SUN_ROLES
from app.numerics.arrays import FloatArray, IntArray

POSITIONS = slice(0, 3 * len(SUN_ROLES))
"""The columns of the joints' positions in the frame features."""

MEAN_FEATURES = np.r_[POSITIONS, TRAVEL]
"""The features whose means are used. The mean velocity of a joint is near 0 for all motions."""

WIDTH = len(MEAN_FEATURES) + FEATURES
"""The length of a window vector: 125."""

RIDGE = 1e-3
"""Added to variances, so that the logarithm of a still feature is finite."""

VARIANCE_SCALE = 1 / 8
"""The weight of the logarithms, which makes them about as large as the means."""


@dataclass(frozen=True, slots=True)
class WindowScale:
    """Windows of one length.

    name: as in the names of the arrays. frames: the length, and hop: the distance between the
    starts of two windows, both in frames at WARPING_RATE.
    """

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
"""From short to long. With hops of half a window, pieces between two windows are often missed."""


def window_arrays(features_10hz: FloatArray) -> dict[str, FloatArray]:
    """The arrays of all WINDOW_SCALES by name, for features (m, 82) at WARPING_RATE.

    window_vectors_*: (w, 125) float16. window_spans_*: (w, 2) float32, start and end in seconds.
    """
    arrays: dict[str, FloatArray] = {}
    sums = RunningSums(features_10hz)
    for scale in WINDOW_SCALES:
        frames = window_frames(len(features_10hz), scale)
        arrays[scale.vectors] = sums.vectors(frames)
        arrays[scale.spans] = (frames / WARPING_RATE).astype(np.float32)
    return arrays


def window_frames(count: int, scale: WindowScale) -> IntArray:
    """(w, 2) the first frame, and the frame after the last, of each window.

    count: the frames of the motion. The last window ends with the motion. A motion that is
    shorter than a window is one window.
    """
    last = max(count - scale.frames, 0)
    firsts = np.arange(0, last + 1, scale.hop)
    if firsts[-1] < last:
        firsts = np.append(firsts, last)
    return np.stack([firsts, np.minimum(firsts + scale.frames, count)], axis=1)


class RunningSums:
    """Sums of frame features and of their squares up to each frame.

    The sum over any window is the difference of two of them.
    """

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
        # only rounding makes variances negative
        logarithms = np.log(np.maximum(variances, 0.0) + RIDGE) * VARIANCE_SCALE
        return np.hstack([means[:, MEAN_FEATURES], logarithms]).astype(np.float16)


def _running(values: FloatArray) -> FloatArray:
    """(m + 1, d) float64: row i is the sum of the first i rows of `values` (m, d)."""
    sums = np.zeros((len(values) + 1, values.shape[1]))
    np.cumsum(values, axis=0, dtype=np.float64, out=sums[1:])
    return sums
