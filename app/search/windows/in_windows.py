"""Where inside clips a query is found (DESIGN 7): windows propose, warping decides and bounds.

`vector` ranks windows by their vectors alone, `dtw` warps the query onto every clip that
passes, `fused` onto what the nearest windows propose, and sums both distances.
"""

from __future__ import annotations

import numpy as np

from app.analysis.descriptors.frame_features import WARPING_RATE
from app.numerics.arrays import FloatArray
from app.search.example.distances import Loader
from app.search.example.methods import Method
from app.search.ranking.cursor import Anchor
from app.search.ranking.ranking import IdArray
from app.search.windows.overlap_merging import Candidates, FoundInterval, merge_overlapping
from app.search.windows.proposals import (
    ExcludedInterval,
    Proposals,
    QuerySegment,
    View,
    propose,
    scale_for,
)
from app.search.windows.warped_matches import Region, matches_in, merged, together

MAX_PROPOSED = 500
MIN_PROPOSED = 10
"""Places that `fused` warps a query onto: as many as CELLS allow, between these."""

CELLS = 2_500_000
"""Pairs of frames that `fused` compares: some 80 ms, or a second for the longest query."""

VECTOR_WEIGHT = 0.02
"""Weight of the windows' distance beside the warping's in `fused`: it decides between likes.

Chosen on half of the real clips, AP@5: pieces hidden in 35 minutes .971 (0 .972, 0.1 .955,
0.4 .907), other takes of the same task and person .870 (0 .867, 0.1 .876, 0.4 .868).
`tests/bench/test_windows.py` measures it, and reports on the other half.
"""

WINDOW_SCORES = {Method.FUSED: 1.0, Method.VECTOR: 0.75, Method.DTW: 1.0}
"""Distance at which the score is one half, by each method that finds parts of clips: about
that of the nearest unlike ones; a segment and itself, hidden and warped, are at .3 to .4."""


def by_windows(view: View, segment: QuerySegment, excluded: ExcludedInterval | None) -> Candidates:
    """Every window of the clips that pass, at the place where the query would be."""
    return propose(view, segment, excluded).candidates()


def by_warping(
    clips: IdArray,
    seconds: FloatArray,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
) -> Candidates:
    """Every match of the query in these clips (c,), which are so long (c,)."""
    whole = [Region(number) for number in range(len(clips))]
    return matches_in(clips, seconds, whole, segment, excluded, load)


def by_both(
    view: View,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
    anchor: Anchor | None = None,
) -> tuple[Candidates, Anchor | None]:
    """The query's matches near the nearest windows; behind them, all windows in their order.

    The anchor that is returned, given again for the next page, keeps the same places before
    the others, however the library has grown.
    """
    proposed = propose(view, segment, excluded)
    rest = proposed.candidates()
    nearest = _nearest(rest, segment, anchor)
    if not nearest:
        return rest, None
    regions = _regions(proposed, [place.index for place in nearest], segment)
    ids = proposed.windows.ids
    matched = matches_in(ids, proposed.windows.seconds(), regions, segment, excluded, load)
    centers = (matched.starts + matched.ends) / 2
    head = matched.distances + VECTOR_WEIGHT * proposed.distances_near(matched.owners, centers)
    last = nearest[-1]
    end = float(head.max(initial=0.0))
    if anchor is None or anchor.end is None:
        anchor = Anchor(last.distance, last.key, end)
    else:
        end = anchor.end
    tail = end + np.maximum(rest.distances - anchor.distance, 0.0)
    return together([matched.at(head), rest.at(tail)]), anchor


def _nearest(
    proposed: Candidates, segment: QuerySegment, anchor: Anchor | None
) -> list[FoundInterval]:
    """The places that a query is warped onto: as many as it can, or as those of `anchor`."""
    if anchor is None:
        return merge_overlapping(proposed, _how_many(segment))[0]
    near = proposed.distances <= anchor.distance
    return merge_overlapping(proposed, int(near.sum()), until=anchor.distance)[0]


def _how_many(segment: QuerySegment) -> int:
    """Places to warp the query onto: tables are about three times as wide as the query."""
    cells = 3 * len(segment.features) ** 2
    return int(np.clip(CELLS // cells, MIN_PROPOSED, MAX_PROPOSED))


def _regions(proposed: Proposals, chosen: list[int], segment: QuerySegment) -> list[Region]:
    """Where the chosen places could really be: half the query's length more on both sides."""
    hop = scale_for(len(segment.features)).hop / WARPING_RATE
    margin = segment.seconds / 2 + hop
    rows = proposed.allowed[chosen]
    firsts = np.maximum((proposed.starts[rows] - margin) * WARPING_RATE, 0).astype(int)
    stops = np.ceil((proposed.ends[rows] + margin) * WARPING_RATE).astype(int)
    owners = proposed.windows.owners[rows]
    return merged(
        Region(int(clip), int(first), int(stop))
        for clip, first, stop in zip(owners, firsts, stops, strict=True)
    )
