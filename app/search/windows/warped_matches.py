"""Matches of a query by time warping, in regions of clips or in whole clips."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.frame_features import WARPING_RATE
from app.deadline import check
from app.numerics.alignment.subsequence_dtw import subsequence_dtw
from app.numerics.arrays import FloatArray
from app.search.example.distances import FEATURES, Loader
from app.search.ranking.ranking import IdArray
from app.search.windows.overlap_merging import Candidates
from app.search.windows.proposals import ExcludedInterval, QuerySegment

MAX_CLIPS_AT_ONCE = 256
MAX_FRAMES_AT_ONCE = 200_000
"""Limits of the clips whose features are in memory at a time: 66 MB, or one longer clip."""

MAX_FRAMES = 2**31 - 1
"""The end of a region that has no end: no clip has more frames."""


@dataclass(frozen=True, slots=True)
class Region:
    """A part of the clip with the number `clip`: frames `first` to `stop` - 1 at 10 Hz."""

    clip: int
    first: int = 0
    stop: int = MAX_FRAMES


def matches_in(
    ids: IdArray,
    seconds: FloatArray,
    regions: Sequence[Region],
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    load: Loader,
) -> Candidates:
    """The matches of a query in regions of the clips `ids` (c,).

    seconds: (c,) the durations of the clips. regions: they do not overlap. Clips that were
    deleted during the search have no matches.
    """
    allowed = [part for region in regions for part in _without(region, ids, excluded)]
    allowed.sort(key=lambda region: (region.clip, region.first))
    matches: list[Candidates] = [_no_matches(ids)]
    numbers = list(dict.fromkeys(region.clip for region in allowed))
    for some in _batches(numbers, seconds):
        check()
        features = load([str(ids[number]) for number in some], FEATURES)
        matches.append(_matches(ids, [r for r in allowed if r.clip in some], segment, features))
    return concatenated(matches)


def _batches(numbers: Sequence[int], seconds: FloatArray) -> Iterator[set[int]]:
    """The numbers of clips in batches, within the limits above."""
    some: set[int] = set()
    frames = 0.0
    for number in numbers:
        more = float(seconds[number]) * WARPING_RATE
        if some and (len(some) == MAX_CLIPS_AT_ONCE or frames + more > MAX_FRAMES_AT_ONCE):
            yield some
            some, frames = set(), 0.0
        some.add(number)
        frames += more
    if some:
        yield some


def concatenated(parts: Sequence[Candidates]) -> Candidates:
    """The candidates of all `parts`, at least one, which have the same `ids`."""
    return Candidates(
        parts[0].ids,
        *(
            np.concatenate([getattr(some, name) for some in parts])
            for name in ("owners", "starts", "ends", "distances")
        ),
    )


def merged(regions: Iterable[Region]) -> list[Region]:
    """The regions, by clip and start; regions that overlap or touch are joined."""
    joined: list[Region] = []
    for region in sorted(regions, key=lambda region: (region.clip, region.first)):
        last = joined[-1] if joined else None
        if last is None or last.clip != region.clip or region.first > last.stop:
            joined.append(region)
        else:
            joined[-1] = Region(last.clip, last.first, max(last.stop, region.stop))
    return joined


def _without(region: Region, ids: IdArray, excluded: ExcludedInterval | None) -> list[Region]:
    """The parts of a region outside the excluded interval: none, one or two."""
    if excluded is None or ids[region.clip] != excluded.clip_id:
        return [region]
    first = int(np.floor(excluded.start * WARPING_RATE))
    stop = int(np.ceil(excluded.end * WARPING_RATE))
    before = Region(region.clip, region.first, min(region.stop, first))
    after = Region(region.clip, max(region.first, stop), region.stop)
    return [part for part in (before, after) if part.first < part.stop]


def _matches(
    ids: IdArray,
    regions: Sequence[Region],
    segment: QuerySegment,
    features: Mapping[str, FloatArray],
) -> Candidates:
    loaded = [region for region in regions if str(ids[region.clip]) in features]
    streams = [features[str(ids[region.clip])][region.first : region.stop] for region in loaded]
    matches = subsequence_dtw(segment.features, streams)
    clips = np.array([region.clip for region in loaded], dtype=np.int64)
    firsts = np.array([region.first for region in loaded], dtype=np.int64)
    starts = (matches.starts + firsts[matches.streams]) / WARPING_RATE
    # the query is longer than its frames at 10 Hz by a part of a frame
    rest = segment.seconds - len(segment.features) / WARPING_RATE
    ends = (matches.ends + firsts[matches.streams]) / WARPING_RATE + rest
    return Candidates(ids, clips[matches.streams], starts, ends, matches.costs.astype(np.float64))


def _no_matches(ids: IdArray) -> Candidates:
    return Candidates(ids, np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(3)))
