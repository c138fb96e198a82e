"""Ranks the clips of a library by their distance to a query motion, by any method."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.example.containment import containment
from app.search.example.distances import (
    ACTIVE,
    EPSILON,
    FEATURES,
    RHO,
    Descriptors,
    Loader,
    distances_to,
)
from app.search.example.fusion import SHORTLIST, FusedDistance, Neighborhood
from app.search.example.guests import Guests
from app.search.example.methods import Method
from app.search.example.reranking import ShortlistRanking
from app.search.example.same_recording import FARTHEST, same_recording
from app.search.example.window_distances import window_distances
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.vector_index import PACED, VECTOR, VectorIndex
from app.search.ranking.cursor import Anchor
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray, Ranked, Ranking
from app.store.clips.filter import ClipFilter

COMPARED = (VECTOR, PACED, FEATURES, ACTIVE, RHO, EPSILON)
"""Names of the arrays of a query that the methods compare, but for learned metrics."""

CONSULTED = 30
"""Number of nearest clips by vectors or windows, of nearest ones at a common pace, and of nearest
ones by windows, that are tested for containment. Of 84 clips of three sources that were repeated,
the first two kinds missed the original of 3, which was the nearest by windows in all three."""

SCALES = {
    Method.FUSED: 5.0,
    Method.VECTOR: 1.5,
    Method.DTW: 1.0,
    Method.MSV_DTW: 1.0,
    Method.MSV_XCORR: 0.1,
}
"""Distance with a score of 0.5: about the distance of two clips of different tasks."""


def rank_by_example(
    index: VectorIndex,
    query: Descriptors,
    method: Method,
    clip_filter: ClipFilter,
    exclude: frozenset[str],
    load: Loader,
    anchor: Anchor | None = None,
    paced: VectorIndex | None = None,
) -> Ranked:
    """All clips that pass the filter and are not excluded, in order of distance.

    exclude: clip ids. load: loads arrays of clips. anchor: from the cursor of the request, if the
    request has one. paced: the index of the vectors at a common pace, for `fused` at any tempo.
    """
    if method in (Method.FUSED, Method.VECTOR):
        near = index.nearest(query[VECTOR], clip_filter, exclude)
        if method is Method.VECTOR:
            return near
        if paced is None:
            reranked = partial(_reranked, query, near, load)
            return ShortlistRanking(near, reranked, SHORTLIST, anchor)
        guests = Guests(near, paced.nearest(query[PACED], clip_filter, exclude))
        reranked = partial(_at_any_tempo, query, guests, load)
        return ShortlistRanking(near, reranked, SHORTLIST, anchor, guests)
    ids = index.candidates(clip_filter, exclude).ids
    return _ranking(ids, distances_to(query, list(ids), method, load))


def _reranked(query: Descriptors, near: NearestRanking, load: Loader, ids: IdArray) -> LowerBounds:
    return fused(query, ids, near.vectors(ids), load)


def fused(query: Descriptors, ids: IdArray, vectors: FloatArray, load: Loader) -> LowerBounds:
    """The fused distances of the clips of a shortlist, at the query's tempo.

    ids: (m,); vectors: (m, 128) the motion vectors of these clips.
    """
    neighborhood = Neighborhood.of(query[VECTOR], vectors)
    return _View(query, neighborhood.seen_from(0), load).of(ids)


def _at_any_tempo(query: Descriptors, guests: Guests, load: Loader, ids: IdArray) -> LowerBounds:
    neighborhood = Neighborhood.of(query[VECTOR], guests.first.vectors(ids))
    paced, windows = guests.view.distances_of(ids), window_distances(query, ids.tolist(), load)
    near = neighborhood.seen_from(0).nearer(paced, windows)
    nearest = [_nearest(each, CONSULTED) for each in (near.near, paced, windows)]
    consulted = np.unique(np.concatenate(nearest))
    parts = containment(query, ids[consulted].tolist(), load, FARTHEST)
    contained = np.full(len(ids), np.inf)
    contained[consulted] = parts.posed
    own = _View(query, near.contained(contained), load).of(ids)
    same = same_recording(parts.of_recordings)
    number = 0 if same is None else int(consulted[same.number])
    recording = {} if same is None else _warped_arrays(ids[number], load)
    if same is None or not recording:
        return own
    other = _View(recording, neighborhood.seen_from(number + 1), load).of(ids)
    return LowerBounds(
        ids,
        same.seen(own.bounds, other.bounds),
        lambda rows: same.seen(own.measure(rows), other.measure(rows)),
    )


def _nearest(distances: FloatArray, count: int) -> IntArray:
    """The indices of the `count` smallest distances; equal ones in their order."""
    return np.argsort(distances, kind="stable")[:count]


def _warped_arrays(clip_id: str, load: Loader) -> Descriptors:
    """What warping compares of a clip; empty if the clip was deleted during the search."""
    found = {name: load([clip_id], name).get(clip_id) for name in (FEATURES, ACTIVE)}
    known = {name: array for name, array in found.items() if array is not None}
    return known if len(known) == len(found) else {}


@dataclass(frozen=True, slots=True)
class _View:
    """How far clips are from one motion: from the query, or from a clip with its recording."""

    motion: Descriptors
    by_vectors: FusedDistance
    load: Loader

    def of(self, ids: IdArray) -> LowerBounds:
        """Warping is the slowest part, so it is measured last, and only if a page needs it."""

        def measure(rows: IntArray) -> FloatArray:
            warped = distances_to(self.motion, ids[rows].tolist(), Method.DTW, self.load)
            return self.by_vectors.distances(rows, warped)

        # with 0 for all warping distances, fused distances are lower bounds
        bounds = self.by_vectors.distances(np.arange(len(ids)), np.zeros(len(ids)))
        return LowerBounds(ids, bounds, measure)


def _ranking(ids: IdArray, distances: FloatArray) -> Ranking:
    """The ranking; clips that were deleted during the comparison are left out."""
    is_stored = np.isfinite(distances)
    return Ranking(ids[is_stored], distances[is_stored])
