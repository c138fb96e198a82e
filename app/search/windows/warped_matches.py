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
"""Clips whose features are held at a time: 66 MB, or those of one clip that is longer."""

MAX_FRAMES = 2**31 - 1
"""More frames than any clip has."""


@dataclass(frozen=True, slots=True)
class Region:
    """Frames `first` to `stop` - 1, at 10 Hz, of the clip with that number."""

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
    """The matches of a query in regions of the clips `ids` (c,), which do not overlap.

    seconds: (c,) how long the clips are. Clips that were deleted meanwhile have no matches.
    """
    allowed = [part for region in regions for part in _without(region, ids, excluded)]
    allowed.sort(key=lambda region: (region.clip, region.first))
    found: list[Candidates] = [_none(ids)]
    numbers = list(dict.fromkeys(region.clip for region in allowed))
    for some in _together(numbers, seconds):
        check()
        features = load([str(ids[number]) for number in some], FEATURES)
        found.append(_matches(ids, [r for r in allowed if r.clip in some], segment, features))
    return together(found)


def _together(numbers: Sequence[int], seconds: FloatArray) -> Iterator[set[int]]:
    """The clips with these numbers, in groups whose features are in memory together."""
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


def together(found: Sequence[Candidates]) -> Candidates:
    """Candidates of the same clips, one after the other."""
    return Candidates(
        found[0].ids,
        *(
            np.concatenate([getattr(some, name) for some in found])
            for name in ("owners", "starts", "ends", "distances")
        ),
    )


def merged(regions: Iterable[Region]) -> list[Region]:
    """The regions; those that touch are joined."""
    whole: list[Region] = []
    for region in sorted(regions, key=lambda region: (region.clip, region.first)):
        last = whole[-1] if whole else None
        if last is None or last.clip != region.clip or region.first > last.stop:
            whole.append(region)
        else:
            whole[-1] = Region(last.clip, last.first, max(last.stop, region.stop))
    return whole


def _without(region: Region, ids: IdArray, excluded: ExcludedInterval | None) -> list[Region]:
    """What is left of a region without the frames of the excluded interval."""
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
    there = [region for region in regions if str(ids[region.clip]) in features]
    streams = [features[str(ids[region.clip])][region.first : region.stop] for region in there]
    found = subsequence_dtw(segment.features, streams)
    clips = np.array([region.clip for region in there], dtype=np.int64)
    firsts = np.array([region.first for region in there], dtype=np.int64)
    starts = (found.starts + firsts[found.streams]) / WARPING_RATE
    # the query goes on for a part of a frame behind its last one
    rest = segment.seconds - len(segment.features) / WARPING_RATE
    ends = (found.ends + firsts[found.streams]) / WARPING_RATE + rest
    return Candidates(ids, clips[found.streams], starts, ends, found.costs.astype(np.float64))


def _none(ids: IdArray) -> Candidates:
    return Candidates(ids, np.zeros(0, dtype=np.int64), *(np.zeros(0) for _ in range(3)))
