"""How near the windows of a query are to windows of clips: for motions of different lengths.

The motion vector of a part of a motion differs from that of the whole: in its mean pose, in what
changes from start to end, in how much each joint moves. The windows of one second that are stored
for searches inside clips have one length in all clips. So a cut motion has the windows of its
original, and windows like those of other clips of its task. Our own.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.analysis.descriptors.windows import WINDOW_SCALES, RunningSums, window_frames
from app.deadline import check
from app.numerics.arrays import FloatArray
from app.numerics.euclidean import distances
from app.search.example.distances import ACTIVE, FEATURES, Descriptors, Loader, active_frames

SCALE = WINDOW_SCALES[0]
"""Windows of one second: of 2 s, a query of 2 s would have only one."""

MAX_WINDOWS = 16
"""Largest number of windows of a query; a longer query has them evenly spaced."""

BATCH = 32
"""The number of clips that are compared at a time. It bounds the memory."""


def window_distances(query: Descriptors, clip_ids: Sequence[str], load: Loader) -> FloatArray:
    """(n,) the mean distance of the query's windows to the nearest window of each clip.

    The unit is that of motion vectors, about. Infinity for a clip without the array (it was
    deleted during the search).
    """
    own = _windows(active_frames(query[FEATURES], query[ACTIVE]))
    found = np.full(len(clip_ids), np.inf)
    for first in range(0, len(clip_ids), BATCH):
        check()
        windows = load(clip_ids[first : first + BATCH], SCALE.vectors)
        for row, clip_id in enumerate(clip_ids[first : first + BATCH], first):
            if clip_id in windows:
                apart = distances(own, windows[clip_id].astype(np.float32))
                found[row] = apart.min(axis=1).mean()
    return found


def _windows(features: FloatArray) -> FloatArray:
    """(w, 125) float32 windows of the active part (m, 82) of a query."""
    frames = window_frames(len(features), SCALE)
    some = frames[:: -(-len(frames) // MAX_WINDOWS)]
    return RunningSums(features).vectors(some).astype(np.float32)
