"""Rank the library against a query motion, by any method."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.example.distances import Descriptors, Loader, distances_to
from app.search.example.fusion import SHORTLIST, FusedDistance
from app.search.example.methods import Method
from app.search.example.reranking import ShortlistRanking
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.vector_index import VECTOR, VectorIndex
from app.search.ranking.cursor import Anchor
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray, Page, Ranked, Ranking
from app.store.clips.filter import ClipFilter

SCALES = {
    Method.FUSED: 5.0,
    Method.VECTOR: 1.5,
    Method.DTW: 1.0,
    Method.MSV_DTW: 1.0,
    Method.MSV_XCORR: 0.1,
}
"""Distance at which the score is one half: about that of two clips of unlike tasks."""


def rank_by_example(
    index: VectorIndex,
    query: Descriptors,
    method: Method,
    clip_filter: ClipFilter,
    exclude: frozenset[str],
    load: Loader,
    anchor: Anchor | None = None,
) -> Ranked:
    """All clips that pass the filter and are not excluded, in order of distance.

    anchor: of the cursor whose next page is asked for, if there is one.
    """
    if method in (Method.FUSED, Method.VECTOR):
        near = index.nearest(query[VECTOR], clip_filter, exclude)
        if method is Method.VECTOR:
            return near
        return ShortlistRanking(near, partial(_fused, query, near, load), SHORTLIST, anchor)
    ids = index.candidates(clip_filter, exclude).ids
    return _known(ids, distances_to(query, list(ids), method, load))


def _fused(query: Descriptors, near: NearestRanking, load: Loader, shortlist: Page) -> LowerBounds:
    """The fused distances of the shortlist; warping costs most, so it is measured last."""
    ids = shortlist.ids
    known = FusedDistance.of(query[VECTOR], near.vectors(ids))

    def measure(rows: IntArray) -> FloatArray:
        warped = distances_to(query, ids[rows].tolist(), Method.DTW, load)
        return known.distances(rows, warped)

    every = np.arange(len(ids))
    return LowerBounds(ids, known.distances(every, np.zeros(len(ids))), measure)


def _known(ids: IdArray, distances: FloatArray) -> Ranking:
    """The ranking; clips that were deleted during the comparison are left out."""
    there = np.isfinite(distances)
    return Ranking(ids[there], distances[there])
