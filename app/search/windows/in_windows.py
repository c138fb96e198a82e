"""Find the parts of clips that are like a query: windows propose them, warping bounds them.

`vector` ranks windows by their vectors alone. `dtw` warps the query onto every clip that passes the
filter. `fused` warps it onto the parts that the nearest windows propose, and adds both distances.
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
    WindowsAtScale,
    propose,
    scale_for,
)
from app.search.windows.warped_matches import Region, matches_in, merged, together

MAX_PROPOSED = 500
MIN_PROPOSED = 10
"""Number of parts that `fused` warps a query onto: as many as CELLS allow, between these."""

CELLS = 2_500_000
"""Pairs of frames that `fused` compares: about 80 ms, or one second for the longest query."""

VECTOR_WEIGHT = 0.02
"""Weight of the windows' distance in `fused`, where that of warping weighs 1. It orders parts that
are equally near by warping.

Chosen on half of the real clips, AP@5: pieces hidden in 35 minutes .971 (0 .972, 0.1 .955,
0.4 .907), other takes of the same task and person .870 (0 .867, 0.1 .876, 0.4 .868).
`tests/bench/test_windows.py` measures it, and reports on the other half.
"""

WINDOW_SCORES = {Method.FUSED: 1.0, Method.VECTOR: 0.75, Method.DTW: 1.0}
"""Distance at which the score is one half, by method: about that of the nearest parts that are not
alike. A piece that was warped and hidden in a clip is found at .3 to .4."""


def by_windows(
    view: WindowsAtScale, segment: QuerySegment, excluded: ExcludedInterval | None
) -> Candidates:
    """One candidate for each window of the clips that pass: where the query would be."""
    return propose(view, segment, excluded).candidates()


def by_warping(
    clips: IdArray,
    seconds: FloatArray,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
) -> Candidates:
    """All matches of the query in the clips (c,); seconds: (c,) how long these are."""
    whole = [Region(number) for number in range(len(clips))]
    return matches_in(clips, seconds, whole, segment, excluded, load)


def by_both(
    view: WindowsAtScale,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
    anchor: Anchor | None = None,
) -> tuple[Candidates, Anchor | None]:
    """The query's matches near the nearest windows; behind them, all windows in their order.

    Give the returned anchor again for the next page. Then the same parts come first, although the
    library has grown.
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
    """The parts that a query is warped onto: as many as it allows, or those before `anchor`."""
    if anchor is None:
        return merge_overlapping(proposed, _how_many(segment))[0]
    near = proposed.distances <= anchor.distance
    return merge_overlapping(proposed, int(near.sum()), until=anchor.distance)[0]


def _how_many(segment: QuerySegment) -> int:
    """Number of parts to warp the query onto: tables are about three times as wide as it is."""
    cells = 3 * len(segment.features) ** 2
    return int(np.clip(CELLS // cells, MIN_PROPOSED, MAX_PROPOSED))


def _regions(proposed: Proposals, chosen: list[int], segment: QuerySegment) -> list[Region]:
    """The chosen parts, longer by half the query on both sides, to find where they really are."""
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
