"""The cycles of a clip for Perera's tensor: all with equally many segments and poses.

A dance that repeats a sequence of steps is cut at its keyposes into segments, and these are grouped
into cycles (section 5.4: trained on one cycle, tested with another). A motion that does not repeat
itself is one segment.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.analysis.descriptors.frame_features import WARPING_RATE
from app.analysis.segments.segments import SEGMENT_CYCLES, SEGMENT_SPANS
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.resampling import resample_to, sample_at
from app.numerics.arrays import FloatArray, IntArray

POSES = 16
"""The number of poses of a segment, evenly spaced in time, including both keyposes."""

_POSITIONS = slice(0, 3 * len(SUN_ROLES))


@dataclass(frozen=True, slots=True)
class DancedCycles:
    """The segments of a repeated sequence.

    segments: (s, POSES, 13, 3) positions in the body frame, body lengths, in order of time
    without gaps. length: how many segments make one cycle; it may begin at any segment.
    """

    segments: FloatArray
    length: int

    def cycles(self, shift: int = 0) -> FloatArray:
        """(c, length, POSES, 13, 3) all complete cycles from segment `shift` on."""
        count = (len(self.segments) - shift) // self.length
        whole = self.segments[shift : shift + count * self.length]
        return whole.reshape(count, self.length, *self.segments.shape[1:])


def danced_cycles(arrays: Mapping[str, Any]) -> DancedCycles:
    """The longest run of cycles of a clip, or the whole clip if nothing is repeated.

    arrays: the stored arrays of the clip: features_10hz (m, 82), segment_spans (s, 2) and
    segment_cycles (c, 3).
    """
    poses = np.asarray(arrays["features_10hz"], dtype=np.float64)[:, _POSITIONS]
    first, stop, length = _longest(np.asarray(arrays[SEGMENT_CYCLES], dtype=np.int64))
    if not length:
        return DancedCycles(resample_to(poses, POSES).reshape(1, POSES, -1, 3), 1)
    spans = np.asarray(arrays[SEGMENT_SPANS], dtype=np.float64)[first:stop] * WARPING_RATE
    at = spans[:, :1] + np.diff(spans, axis=1) * np.linspace(0.0, 1.0, POSES)
    cut = sample_at(poses, at.ravel())
    return DancedCycles(cut.reshape(stop - first, POSES, -1, 3), length)


def _longest(cycles: IntArray) -> tuple[int, int, int]:
    """The first segment, the stop, and the segments of a cycle, of the longest run.

    Only cycles (c, 3) with the most common number of segments count. All three are 0 if there are
    no cycles.
    """
    if not len(cycles):
        return 0, 0, 0
    lengths = cycles[:, 1] - cycles[:, 0]
    ((usual, _),) = Counter(sorted(lengths.tolist())).most_common(1)
    best, start = (0, 0), 0
    for stop in range(1, len(cycles) + 1):
        if lengths[stop - 1] != usual:
            start = stop
        elif stop - 1 > start and cycles[stop - 1, 2] != cycles[stop - 2, 2]:
            start = stop - 1
        if stop - start > best[1] - best[0]:
            best = start, stop
    return int(cycles[best[0], 0]), int(cycles[best[1] - 1, 1]), usual
