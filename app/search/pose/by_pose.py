"""Rank clips by the distance of their nearest frame to one pose, exactly.

Each clip's pose cover gives a lower bound of this distance: the distance to a pose of the cover
less that pose's radius. The frames of the clips are compared in the order of these bounds, and
clips with equal bounds in the order of their ids, until no other clip can come before the last hit.
So no hit is missed, and most clips are never read, also if many clips contain the same pose.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.pose_cover import POSE_WIDTH, pose_vectors
from app.deadline import check
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.nearest import DECIMALS, squared_distances
from app.search.example.distances import Loader
from app.search.index.rows import Layout, RowsView
from app.search.pose.pose_matches import MatchesPerClip, PoseMatch, pose_matches
from app.search.ranking.cursor import Position

POSES = Layout(("pose_cover",), POSE_WIDTH, facts=2, several=True)
"""The rows of the pose index; their facts are frame and radius."""
POSITIONS = "role_positions"
FIRST_CLIPS = 16
"""The number of clips whose frames are compared first. Each time, twice as many follow."""

MAX_CLIPS_AT_ONCE = 64
"""The largest number of clips whose frames are compared at a time."""

SORTED_FIRST = 1024
"""The number of clips that are sorted first. If they are not enough, four times as many follow."""

MAX_FRAMES_AT_ONCE = 100_000
"""The largest number of poses that are compared at a time."""

_RADIUS = 1
"""The column of the facts that holds the radius."""


@dataclass(frozen=True, slots=True)
class PoseHit:
    """A clip, and the frames in which it is near the pose."""

    clip_id: str
    match: PoseMatch

    @property
    def key(self) -> tuple[float, str]:
        """Distance, then clip and frame: sorts hits, and identifies a hit in a cursor."""
        return self.match.distance, f"{self.clip_id} {self.match.frame:08d}"


@dataclass(frozen=True, slots=True)
class PosePage:
    """Some hits of a ranking by pose. more: whether other hits follow."""

    hits: tuple[PoseHit, ...]
    more: bool


class PoseRanking:
    """The hits in all clips that pass a filter, the nearest first."""

    def __init__(
        self,
        rows: RowsView,
        mask: BoolArray,
        query: FloatArray,
        load: Loader,
        per_clip: MatchesPerClip = MatchesPerClip.BEST,
    ) -> None:
        """Prepare a search; frames are compared when a page is read.

        rows: of an index with the layout POSES. mask: (n,) the clips that pass the filter.
        query: (36,) a pose vector. load: loads POSITIONS (frames, 13, 3) of clips. per_clip: how
        many hits a clip may have.
        """
        self._ids = rows.labels.ids
        self._query = query.astype(np.float64)
        self._load = load
        self._per_clip = per_clip
        self._bounds = pose_bounds(rows, query)
        self._mask = mask

    def page(self, after: Position | None, limit: int) -> PosePage:
        """The first `limit` hits after a position. Its `clip_id` is the text of a `PoseHit.key`."""
        last_seen = (-1.0, "") if after is None else (after.distance, after.clip_id)
        hits: list[PoseHit] = []
        for numbers in self._batches():
            if len(hits) > limit and not self._may_precede(int(numbers[0]), hits[-1]):
                break
            farthest = hits[-1].match.distance if len(hits) > limit else np.inf
            hits += [hit for hit in self._hits_in(numbers, farthest) if hit.key > last_seen]
            # one hit more than the page, so that the page knows whether others follow
            hits = sorted(hits, key=lambda hit: hit.key)[: limit + 1]
        return PosePage(tuple(hits[:limit]), len(hits) > limit)

    def _may_precede(self, number: int, hit: PoseHit) -> bool:
        """Whether a clip can have a frame that comes before a hit."""
        bound = self._bounds[number], str(self._ids[number])
        return bound <= (hit.match.distance, hit.clip_id)

    def _batches(self) -> Iterator[IntArray]:
        """The numbers of the clips by bound and id, in batches."""
        size = FIRST_CLIPS
        for numbers in self._in_order():
            first = 0
            while first < len(numbers):
                size = min(size, MAX_CLIPS_AT_ONCE)
                yield numbers[first : first + size]
                first, size = first + size, 2 * size

    def _in_order(self) -> Iterator[IntArray]:
        """The numbers of the clips by bound and id. Only as many are sorted as are read."""
        numbers, count = np.flatnonzero(self._mask), SORTED_FIRST
        while len(numbers):
            bounds = self._bounds[numbers]
            last = np.inf if len(numbers) <= count else np.partition(bounds, count)[count]
            is_near = bounds <= last
            near = numbers[is_near]
            yield near[np.lexsort((self._ids[near].astype(str), bounds[is_near]))]
            numbers, count = numbers[~is_near], 4 * count

    def _hits_in(self, numbers: IntArray, max_distance: float) -> list[PoseHit]:
        """The hits in the clips with these numbers that have one within `max_distance`.

        Deleted clips have none.
        """
        clip_ids = [str(clip_id) for clip_id in self._ids[numbers]]
        loaded = self._load(clip_ids, POSITIONS)
        there = [clip_id for clip_id in clip_ids if clip_id in loaded]
        if not there:
            return []
        starts = np.cumsum([0, *(len(loaded[clip_id]) for clip_id in there)])
        distances = self._distances(np.concatenate([loaded[i] for i in there]))
        nearest = np.round(np.minimum.reduceat(distances, starts[:-1]), DECIMALS)
        # Most clips are too far, and to find their matches would take longer than this look.
        return [
            PoseHit(there[i], match)
            for i in np.flatnonzero(nearest <= max_distance).tolist()
            for match in pose_matches(distances[starts[i] : starts[i + 1]], self._per_clip)
        ]

    def _distances(self, positions: FloatArray) -> FloatArray:
        """(n,) distances of poses (n, 13, 3), in batches.

        A request whose client left, or whose time is up, stops between two batches.
        """
        distances = np.empty(len(positions))
        for first in range(0, len(positions), MAX_FRAMES_AT_ONCE):
            check()
            some = slice(first, first + MAX_FRAMES_AT_ONCE)
            distances[some] = pose_distances(positions[some], self._query)
        return distances


def pose_distances(positions: FloatArray, query: FloatArray) -> FloatArray:
    """(n,) root mean square joint distances of poses (n, 13, 3) to a pose vector (36,).

    The unit is the body length. Poses of size 0 have an infinite distance.
    """
    apart = pose_vectors(positions).astype(np.float64) - query
    distances = np.sqrt(np.vecdot(apart, apart))
    return np.where(np.isnan(distances), np.inf, distances)


def pose_bounds(rows: RowsView, query: FloatArray) -> FloatArray:
    """(n,) for each clip a lower bound, at least 0, of its frames' distances to `query` (36,)."""
    if rows.starts is None or not len(rows.starts):
        return np.zeros(0)
    squares, error = squared_distances(rows.blocks, query)
    squares -= np.float32(error)
    np.sqrt(np.maximum(squares, 0.0, out=squares), out=squares)
    squares -= rows.facts[:, _RADIUS]
    bounds = np.minimum.reduceat(squares, rows.starts)
    return np.asarray(np.maximum(bounds, 0.0, out=bounds))
