"""Rank clips by the distance of their nearest frame to one pose, exactly.

Each clip's pose cover gives a lower bound of this distance: the distance to a pose of the cover
less that pose's radius. The frames of clips are compared in the order of these bounds, until no
other clip can be nearer than those found. So nothing is missed, and most clips are never read.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.pose_cover import POSE_WIDTH, pose_vectors
from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.nearest import squared_distances
from app.search.example.distances import Loader
from app.search.index.rows import Layout, RowsView
from app.search.pose.pose_places import Places, PosePlace, pose_places
from app.search.ranking.cursor import Position

POSES = Layout(("pose_cover",), POSE_WIDTH, facts=2, several=True)
"""Rows of the index of poses; their facts are frame and radius."""
POSITIONS = "role_positions"
AT_ONCE = 64
"""Clips whose frames are compared at a time."""

FRAMES_AT_ONCE = 100_000
"""Poses that are compared at a time."""

_RADIUS = 1


@dataclass(frozen=True, slots=True)
class PoseHit:
    """A place of a clip where a pose is taken."""

    clip_id: str
    place: PosePlace

    @property
    def key(self) -> tuple[float, str]:
        """Orders hits, and names one in a cursor: by distance, clip, frame."""
        return self.place.distance, f"{self.clip_id} {self.place.frame:08d}"


@dataclass(frozen=True, slots=True)
class PosePage:
    """Part of a ranking by pose; more: whether hits follow."""

    hits: tuple[PoseHit, ...]
    more: bool


class PoseRanking:
    """All places of the clips that pass a filter, in order of distance."""

    def __init__(
        self,
        rows: RowsView,
        mask: BoolArray,
        query: FloatArray,
        load: Loader,
        places: Places = Places.BEST,
    ) -> None:
        """rows: of POSES; mask: (n,) the clips that pass; query: (36,) a pose vector."""
        self._ids = rows.labels.ids
        self._query = query.astype(np.float64)
        self._load = load
        self._places = places
        self._bounds = _bounds(rows, query)
        self._mask = mask

    def page(self, after: Position | None, limit: int) -> PosePage:
        """The first `limit` places behind a position; its clip id is a `PoseHit.key`'s."""
        behind = (-1.0, "") if after is None else (after.distance, after.clip_id)
        hits: list[PoseHit] = []
        farthest, waiting = np.inf, self._mask.copy()
        while len(numbers := self._next(waiting, farthest)):
            hits += [hit for hit in self._look_into(numbers) if hit.key > behind]
            if len(hits) > limit:
                hits = sorted(hits, key=lambda hit: hit.key)[: limit + 1]
                farthest = hits[-1].place.distance
        hits.sort(key=lambda hit: hit.key)
        return PosePage(tuple(hits[:limit]), len(hits) > limit)

    def _next(self, waiting: BoolArray, farthest: float) -> IntArray:
        """Numbers of the next clips that may be so near; they are removed from `waiting` (n,)."""
        numbers = np.flatnonzero(waiting & (self._bounds <= farthest))
        if len(numbers) > AT_ONCE:
            numbers = numbers[np.argpartition(self._bounds[numbers], AT_ONCE)[:AT_ONCE]]
        waiting[numbers] = False
        return numbers

    def _look_into(self, numbers: IntArray) -> list[PoseHit]:
        clip_ids = [str(clip_id) for clip_id in self._ids[numbers]]
        loaded = self._load(clip_ids, POSITIONS)
        there = [clip_id for clip_id in clip_ids if clip_id in loaded]
        if not there:
            return []
        ends = np.cumsum([len(loaded[clip_id]) for clip_id in there])
        distances = self._distances(np.concatenate([loaded[i] for i in there]))
        return [
            PoseHit(clip_id, place)
            for clip_id, own in zip(there, np.split(distances, ends[:-1]), strict=True)
            for place in pose_places(own, self._places)
        ]

    def _distances(self, positions: FloatArray) -> FloatArray:
        """(n,) of all poses, in batches; a request that has ended stops between two of them."""
        found = np.empty(len(positions))
        for first in range(0, len(positions), FRAMES_AT_ONCE):
            check()
            some = slice(first, first + FRAMES_AT_ONCE)
            found[some] = pose_distances(positions[some], self._query)
        return found


def pose_distances(positions: FloatArray, query: FloatArray) -> FloatArray:
    """(n,) RMS joint distances, body lengths, of poses (n, 13, 3) to a pose vector (36,).

    Infinity for poses of no size.
    """
    apart = pose_vectors(positions).astype(np.float64) - query
    distances = np.sqrt(np.vecdot(apart, apart))
    return np.where(np.isnan(distances), np.inf, distances)


def _bounds(rows: RowsView, query: FloatArray) -> FloatArray:
    """(n,) for each clip a lower bound of the distances of its poses."""
    if rows.starts is None or not len(rows.starts):
        return np.zeros(0)
    squares, error = squared_distances(rows.blocks, query)
    squares -= np.float32(error)
    np.sqrt(np.maximum(squares, 0.0, out=squares), out=squares)
    squares -= rows.facts[:, _RADIUS]
    return np.asarray(np.minimum.reduceat(squares, rows.starts))
