"""Segments: what is danced from one keypose to the next, the units that dances are made of
(Perera 2009, section 5.1), each as a vector, and the cycles that they form.

All is computed from the features at 10 Hz that are stored with a clip, so that segments can
follow keyposes that a person corrects, without the motion.
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
"""Poses that a segment is told by, both keyposes among them; 3 or 9 find the same."""
TRAVEL_WEIGHT = 0.5
"""Of the mean velocity and yaw rate, as they stand in the features, beside the poses."""
DURATION_WEIGHT = 0.25
"""Of the duration's logarithm: a step twice as slow is another step, though a like one.

With poses alone 1-NN by task of the segments of every second real clip is .735, with these
weights .77, with the motion vector .78 and with warping .75; on repeated dances all find
nearly all (`tests/bench/test_segments.py` measures the other clips).
"""

_POSITIONS = slice(0, 3 * len(SUN_ROLES))
_MOVING = [column for column, role in enumerate(SUN_ROLES) if role is not JointRole.HIPS]
SEGMENT_WIDTH = 3 * SAMPLES * len(_MOVING) + (TRAVEL.stop - TRAVEL.start) + 1


def describe_segments(features: FloatArray, keyposes: FloatArray) -> dict[str, NDArray[Any]]:
    """The segments of a clip as arrays by name; s segments, c cycles.

    features: (m, 82) at 10 Hz; keyposes: (k,) seconds, rising. segment_spans (s, 2) float32
    seconds; segment_vectors (s, SEGMENT_WIDTH) float16; segment_cycles (c, 3) int32: first
    segment, the one behind the last, and number of the run (see `motion_cycles.Cycle`).
    """
    spans = segment_spans(keyposes)
    cycles = find_cycles(features[:, _POSITIONS], keyposes * WARPING_RATE)
    told = [(cycle.first, cycle.stop, cycle.run) for cycle in cycles]
    return {
        SEGMENT_SPANS: spans.astype(np.float32),
        SEGMENT_VECTORS: segment_vectors(features, spans).astype(np.float16),
        SEGMENT_CYCLES: np.array(told, dtype=np.int32).reshape(len(told), 3),
    }


def segment_spans(keyposes: FloatArray) -> FloatArray:
    """(s, 2) start and end of each segment, from keyposes (s + 1,), in their unit."""
    return np.array(list(pairwise(keyposes)), dtype=np.float64).reshape(-1, 2)


def segment_vectors(features: FloatArray, spans: FloatArray) -> FloatArray:
    """(s, SEGMENT_WIDTH) float32 vectors of parts of a motion, compared by Euclidean distance.

    features: (m, 82) at 10 Hz; spans: (s, 2) seconds. Each has the poses at SAMPLES evenly
    spaced times, such that the squared distance of two is the joints' mean over time in body
    lengths; how the body travels and turns; and how long it takes.
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
    """(s, d) means of values (m, d) over spans (s, 2) in frames, one frame at least."""
    sums = np.vstack([np.zeros(values.shape[1]), np.cumsum(values, axis=0, dtype=np.float64)])
    firsts = np.minimum(spans[:, 0].astype(np.int64), len(values) - 1)
    stops = np.clip(np.ceil(spans[:, 1]).astype(np.int64), firsts + 1, len(values))
    return np.asarray((sums[stops] - sums[firsts]) / (stops - firsts)[:, None])
