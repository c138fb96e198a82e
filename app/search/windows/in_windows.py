"""Finds the parts of clips that are similar to a query, by windows and by warping.

Windows propose likely parts. Warping determines where they begin and end. `vector` ranks windows by
their vectors. `dtw` warps the query onto every clip that passes the filter. `fused` warps it onto
the parts near the nearest windows, and adds both distances.
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
from app.search.windows.warped_matches import Region, concatenated, matches_in, merged

MAX_PROPOSED = 500
MIN_PROPOSED = 10
"""Bounds of the number of parts onto which `fused` warps a query; CELLS determines the number."""

CELLS = 2_500_000
"""The number of pairs of frames that `fused` compares. This takes about 80 ms, or one second for
the longest query."""

VECTOR_WEIGHT = 0.02
"""Weight of the distance of windows in `fused`; the distance of warping has weight 1. It orders
parts that are equally near by warping.

Chosen on half of the real clips, AP@5: pieces hidden in 35 minutes .971 (0 .972, 0.1 .955,
0.4 .907), other takes of the same task and person .870 (0 .867, 0.1 .876, 0.4 .868).
`tests/bench/test_windows.py` measures it, and reports on the other half.
"""

WINDOW_SCORES = {Method.FUSED: 1.0, Method.VECTOR: 0.75, Method.DTW: 1.0}
"""Distance with a score of 0.5, by method: about the distance of the nearest parts that are not
similar. A piece that was warped and hidden in a clip has a distance of .3 to .4."""


def by_windows(
    windows_at: WindowsAtScale, segment: QuerySegment, excluded: ExcludedInterval | None
) -> Candidates:
    """One candidate for each window of the clips that pass: the likely interval of the query."""
    return propose(windows_at, segment, excluded).candidates()


def by_warping(
    clips: IdArray,
    seconds: FloatArray,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
) -> Candidates:
    """All matches of the query in the clips (c,); seconds: (c,) the durations of the clips."""
    whole = [Region(number) for number in range(len(clips))]
    return matches_in(clips, seconds, whole, segment, excluded, load)


def by_both(
    windows_at: WindowsAtScale,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
    anchor: Anchor | None = None,
) -> tuple[Candidates, Anchor | None]:
    """The matches of the query near the nearest windows, and after them all windows in their order.

    For the next page, pass the returned anchor as `anchor`. Then the same parts come first, also
    if clips were added.
    """
    proposed = propose(windows_at, segment, excluded)
    windows = proposed.candidates()
    nearest = _nearest(windows, segment, anchor)
    if not nearest:
        return windows, None
    regions = _regions(proposed, [part.index for part in nearest], segment)
    ids = proposed.windows.ids
    matched = matches_in(ids, proposed.windows.seconds(), regions, segment, excluded, load)
    centers = (matched.starts + matched.ends) / 2
    matched_distances = matched.distances + VECTOR_WEIGHT * proposed.distances_near(
        matched.owners, centers
    )
    last = nearest[-1]
    end = float(matched_distances.max(initial=0.0))
    if anchor is None or anchor.end is None:
        anchor = Anchor(last.distance, last.key, end)
    else:
        end = anchor.end
    # windows begin where the matches end, so that all matches come first
    window_distances = end + np.maximum(windows.distances - anchor.distance, 0.0)
    candidates = [
        matched.with_distances(matched_distances),
        windows.with_distances(window_distances),
    ]
    return concatenated(candidates), anchor


def _nearest(
    proposed: Candidates, segment: QuerySegment, anchor: Anchor | None
) -> list[FoundInterval]:
    """The parts onto which a query is warped: the nearest ones, or those up to `anchor`."""
    if anchor is None:
        return merge_overlapping(proposed, _part_count(segment))[0]
    near = proposed.distances <= anchor.distance
    return merge_overlapping(proposed, int(near.sum()), max_distance=anchor.distance)[0]


def _part_count(segment: QuerySegment) -> int:
    """Number of parts onto which the query is warped.

    A table of costs is about three times as wide as the query, see `_regions`.
    """
    cells = 3 * len(segment.features) ** 2
    return int(np.clip(CELLS // cells, MIN_PROPOSED, MAX_PROPOSED))


def _regions(proposed: Proposals, chosen: list[int], segment: QuerySegment) -> list[Region]:
    """The chosen parts, extended by half the query on both sides.

    The exact interval of a match can be outside of its window.
    """
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
