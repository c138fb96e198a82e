"""Rank the library against a query motion, by any method (DESIGN 7)."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.numerics.arrays import FloatArray
from app.search.cursor import Anchor
from app.search.distances import Loader, QueryArrays, distances_to
from app.search.index import VectorIndex
from app.search.methods import Method
from app.search.rank import IdArray, Page, Ranked, Ranking
from app.search.reranked import ReRanked
from app.store.clip_filter import ClipFilter

SHORTLIST = 200
"""Clips that `fused` re-ranks."""
DTW_WEIGHT = 0.25
"""Weight of the DTW distance beside the vector's in `fused`.

Chosen on three sets (97 clips of dataset 1, 49 of CMU's, the demo): MAP as one library .708,
with the vector alone .704, with weight 1 .687; bands and scaling by each query's median
distance gained nothing. On dataset 2, left out of the choice: P@4 .993 (vector .991, dtw
.988), MAP .649 (.625, .700). `tests/bench/test_retrieval.py` measures both.
"""

SCALES = {
    Method.FUSED: 1.25,
    Method.VECTOR: 1.0,
    Method.DTW: 1.0,
    Method.MSV_DTW: 1.0,
    Method.MSV_XCORR: 0.1,
}
"""Distance at which the score is one half: about that of two clips of unlike tasks."""


def rank_by_example(
    index: VectorIndex,
    query: QueryArrays,
    method: Method,
    wanted: ClipFilter,
    exclude: frozenset[str],
    load: Loader,
    anchor: Anchor | None = None,
) -> Ranked:
    """Every clip that passes the filter and is not excluded, from the nearest on.

    anchor: of the cursor that goes on, if one does.
    """
    if method in (Method.FUSED, Method.VECTOR):
        near = index.nearest(query.vector, wanted, exclude)
        if method is Method.VECTOR:
            return near
        return ReRanked(near, partial(_fused, query, load), SHORTLIST, anchor)
    ids = index.candidates(wanted, exclude).ids
    return _known(ids, distances_to(query, list(ids), method, load))


def _fused(query: QueryArrays, load: Loader, shortlist: Page) -> Ranking:
    """The shortlist by both distances."""
    warped = distances_to(query, list(shortlist.ids), Method.DTW, load)
    return _known(shortlist.ids, fuse(shortlist.distances, warped))


def fuse(vector: FloatArray, warped: FloatArray) -> FloatArray:
    """The distance of `fused` from those of its two stages, each (n,)."""
    return vector + DTW_WEIGHT * warped


def _known(ids: IdArray, distances: FloatArray) -> Ranking:
    """The ranking without clips that were deleted while they were compared."""
    there = np.isfinite(distances)
    return Ranking(ids[there], distances[there])
