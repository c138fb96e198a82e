"""Segments: the motion from one keypose to the next (Perera 2009, section 5.1).

Dances are made of segments. Each gets a vector, and the cycles that segments form are found. All is
computed from the stored features at 10 Hz. So segments can be computed again without the motion if
a person corrects the keyposes.
"""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.descriptors.frame_features import TRAVEL, WARPING_RATE
from app.analysis.segments.cycles import find_cycles
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.resampling import sample_at
from app.numerics.arrays import FloatArray

SEGMENT_VECTORS, SEGMENT_SPANS, SEGMENT_CYCLES = (
    "segment_vectors",
    "segment_spans",
    "segment_cycles",
)
SAMPLES = 5
"""The number of poses of a segment vector, including both keyposes. 3 or 9 work as well."""

TRAVEL_WEIGHT = 0.5
"""The weight of the mean velocity and yaw rate (as in the features); poses have weight 1."""

DURATION_WEIGHT = 0.25
"""The weight of the duration's logarithm: a step that is twice as slow is similar, but different.

The 1-NN accuracy by task, for segments of every second real clip, is .735 with poses alone, .77
with these weights, .78 with the motion vector, and .75 with warping. On repeated dances, all four
find nearly all repetitions (`tests/bench/test_segments.py` measures the other clips).
"""

_POSITIONS = slice(0, 3 * len(SUN_ROLES))
_MOVING = [column for column, role in enumerate(SUN_ROLES) if role is not JointRole.HIPS]
SEGMENT_WIDTH = 3 * SAMPLES * len(_MOVING) + (TRAVEL.stop - TRAVEL.start) + 1


def describe_segments(features: FloatArray, keyposes: FloatArray) -> dict[str, NDArray[Any]]:
    """The arrays, by name, of the s segments and c cycles of a clip.

    features: (m, 82) at 10 Hz. keyposes: (k,) seconds, rising.
    segment_spans: (s, 2) float32, start and end in seconds. segment_vectors: (s, SEGMENT_WIDTH)
    float16. segment_cycles: (c, 3) int32, the first segment, the one after the last, and the
    number of the run (see `cycles.Cycle`).
    """
    spans = segment_spans(keyposes)
    cycles = find_cycles(features[:, _POSITIONS], keyposes * WARPING_RATE)
    rows = [(cycle.first, cycle.stop, cycle.run) for cycle in cycles]
    return {
        SEGMENT_SPANS: spans.astype(np.float32),
        SEGMENT_VECTORS: segment_vectors(features, spans).astype(np.float16),
        SEGMENT_CYCLES: np.array(rows, dtype=np.int32).reshape(len(rows), 3),
    }


def segment_spans(keyposes: FloatArray) -> FloatArray:
    """(s, 2) start and end of each segment, in the unit of the `keyposes` (s + 1,)."""
    return np.array(list(pairwise(keyposes)), dtype=np.float64).reshape(-1, 2)


def segment_vectors(features: FloatArray, spans: FloatArray) -> FloatArray:
    """(s, SEGMENT_WIDTH) float32 vectors of parts of a motion, compared by Euclidean distance.

    features: (m, 82) at 10 Hz. spans: (s, 2) seconds. A vector holds the poses at SAMPLES evenly
    spaced times (in squared body lengths, the squared distance of two is the mean over these
    times of the sum over joints), the mean travel and turn, and the log of the duration.
    """
    spans = np.asarray(spans, dtype=np.float64).reshape(-1, 2)
    at = np.linspace(spans[:, 0], spans[:, 1], SAMPLES, axis=1) * WARPING_RATE
    poses = sample_at(features[:, _POSITIONS].astype(np.float64), at.ravel())
    moving = poses.reshape(len(spans), SAMPLES, len(SUN_ROLES), 3)[:, :, _MOVING]
    lengths = np.maximum(spans[:, 1] - spans[:, 0], 1 / WARPING_RATE)
    return np.hstack(
        [
            moving.reshape(len(spans), 3 * SAMPLES * len(_MOVING)) / np.sqrt(SAMPLES),
            TRAVEL_WEIGHT * _means(features[:, TRAVEL], spans * WARPING_RATE),
            DURATION_WEIGHT * np.log(lengths)[:, None],
        ]
    ).astype(np.float32)


def _means(values: FloatArray, spans: FloatArray) -> FloatArray:
    """(s, d) the means of `values` (m, d) over `spans` (s, 2) in frames, at least one frame."""
    sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0, dtype=np.float64)])
    firsts = np.minimum(spans[:, 0].astype(np.int64), len(values) - 1)
    stops = np.clip(np.ceil(spans[:, 1]).astype(np.int64), firsts + 1, len(values))
    return np.asarray((sums[stops] - sums[firsts]) / (stops - firsts)[:, None])
