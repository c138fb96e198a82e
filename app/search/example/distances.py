"""Distances of clips to a query, by each method that uses more than the motion vector.

Arrays of clips are loaded and compared in batches, so memory stays bounded for any number of clips.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from app.analysis.descriptors.frame_features import WARPING_RATE
from app.analysis.descriptors.motion_volume import (
    MAX_CROSS_CORRELATION,
    cross_correlations,
    warping_distances,
)
from app.deadline import check
from app.numerics.alignment.dtw import dtw_distances
from app.numerics.arrays import FloatArray
from app.search.example.methods import Method

FEATURES, ACTIVE, RHO, EPSILON = "features_10hz", "active_span", "msv_rho", "msv_epsilon"
BATCH = 256
"""The number of clips that are compared at a time."""

Loader = Callable[[Sequence[str], str], Mapping[str, FloatArray]]
"""Loads one array of many clips: (clip ids, array name) -> arrays by clip id."""


Descriptors = Mapping[str, FloatArray]
"""Descriptors of a query by name: its motion vector (128,), FEATURES (m, 82) at 10 Hz and the
ACTIVE part (2,) in seconds, RHO (13,) and EPSILON (a,) of its motion volume. A method needs only
those that it compares."""


def distances_to(
    query: Descriptors, clip_ids: Sequence[str], method: Method, load: Loader
) -> FloatArray:
    """(n,) distances of clips to `query` by DTW, MSV_DTW or MSV_XCORR.

    A clip without the arrays (it was deleted during the search) has an infinite distance.
    """
    names, compare = _COMPARISONS[method]
    distances = np.full(len(clip_ids), np.inf)
    for start in range(0, len(clip_ids), BATCH):
        check()
        loaded = [load(clip_ids[start : start + BATCH], name) for name in names]
        rows = [
            row
            for row, clip_id in enumerate(clip_ids[start : start + BATCH], start)
            if all(clip_id in arrays for arrays in loaded)
        ]
        columns = [[arrays[clip_ids[row]] for row in rows] for arrays in loaded]
        if rows:
            distances[rows] = compare(query, columns)
    return distances


def active_frames(features: FloatArray, span: FloatArray) -> FloatArray:
    """The `features` (m, 82) at 10 Hz within `span` (2,), in seconds; at least one frame."""
    first = min(first_active_frame(span), len(features) - 1)
    return features[first : max(first + 1, int(np.ceil(span[1] * WARPING_RATE)))]


def first_active_frame(span: FloatArray) -> int:
    """The first frame at 10 Hz within `span` (2,), in seconds."""
    return int(span[0] * WARPING_RATE)


def _by_features(query: Descriptors, columns: list[list[FloatArray]]) -> FloatArray:
    clips = [active_frames(*one) for one in zip(*columns, strict=True)]
    return dtw_distances(active_frames(query[FEATURES], query[ACTIVE]), clips)


def _by_volume_dtw(query: Descriptors, columns: list[list[FloatArray]]) -> FloatArray:
    return warping_distances(query[RHO], query[EPSILON], np.stack(columns[0]), columns[1])


def _by_volume_correlation(query: Descriptors, columns: list[list[FloatArray]]) -> FloatArray:
    # a correlation is larger for more similar motions, so it is subtracted from its maximum
    likeness = cross_correlations(query[RHO], query[EPSILON], np.stack(columns[0]), columns[1])
    return np.asarray(np.maximum(MAX_CROSS_CORRELATION - likeness, 0.0))


_Comparison = Callable[[Descriptors, list[list[FloatArray]]], FloatArray]
_COMPARISONS: dict[Method, tuple[tuple[str, ...], _Comparison]] = {
    Method.DTW: ((FEATURES, ACTIVE), _by_features),
    Method.MSV_DTW: ((RHO, EPSILON), _by_volume_dtw),
    Method.MSV_XCORR: ((RHO, EPSILON), _by_volume_correlation),
}
