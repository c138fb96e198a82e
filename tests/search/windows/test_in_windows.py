"""What windows propose and warping decides, against obvious loops; cursors' anchors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest

from app.analysis.descriptors.windows import WIDTH, RunningSums, WindowScale, window_arrays
from app.numerics.arrays import FloatArray
from app.search.index.rows import Rows
from app.search.windows import in_windows
from app.search.windows import warped_matches as matches
from app.search.windows.in_windows import by_both, by_warping, by_windows
from app.search.windows.overlap_merging import Candidates, merge_overlapping
from app.search.windows.parts import Parts, parts_layout
from app.search.windows.proposals import (
    MAX_WINDOWS,
    ExcludedInterval,
    QuerySegment,
    propose,
    scale_for,
)
from app.search.windows.warped_matches import Region, matches_in, merged
from tests.search.indexed import indexed

SECONDS = (30.0, 1.4, 0.5, 12.0)
"""Of the clips."""


@dataclass(frozen=True)
class Clips:
    """Features by clip id, as an index and a store have them."""

    features: Mapping[str, FloatArray]

    @property
    def ids(self) -> np.ndarray:
        return np.array(list(self.features), dtype=object)

    @property
    def seconds(self) -> np.ndarray:
        return np.array([len(one) / 10 for one in self.features.values()])

    def view(self, scale: WindowScale) -> Parts:
        rows = Rows(parts_layout(scale.vectors, scale.spans, WIDTH))
        arrays = {clip_id: window_arrays(one) for clip_id, one in self.features.items()}
        rows.put(
            [
                indexed(clip_id, np.hstack([own[scale.spans], own[scale.vectors]]))
                for clip_id, own in arrays.items()
            ]
        )
        return Parts.of(rows.view())

    def load(self, clip_ids: Sequence[str], _: str) -> Mapping[str, FloatArray]:
        return {clip_id: self.features[clip_id] for clip_id in clip_ids}


def smooth(seconds: float, seed: int) -> FloatArray:
    """(m, 82) features that wander."""
    rng = np.random.default_rng(seed)
    steps = rng.normal(scale=0.1, size=(round(seconds * 10), 82))
    return (rng.normal(size=82) + np.cumsum(steps, axis=0)).astype(np.float32)


@pytest.fixture(scope="module")
def some() -> Clips:
    return Clips({f"clip_{i}": smooth(seconds, i) for i, seconds in enumerate(SECONDS)})


def segment_of(features: FloatArray, start: float, end: float) -> QuerySegment:
    return QuerySegment(features[round(start * 10) : round(end * 10)], end - start)


@pytest.mark.parametrize("frames", [1, 4, 10, 12, 20, 33, 40, 47, 110, 1200])
def test_proposals_are_those_of_a_loop(some: Clips, frames: int) -> None:
    segment = QuerySegment(smooth(frames / 10, 99), frames / 10)
    scale = scale_for(frames)
    found = propose(some.view, segment, None)
    windows = found.windows
    vectors = np.concatenate([block.vectors for block in windows.view.blocks])
    hops = _hops(frames, scale)
    assert len(hops) <= MAX_WINDOWS
    firsts = [min(hop * scale.hop, max(frames - scale.frames, 0)) for hop in hops]
    length = scale.frames if len(hops) > 1 else frames
    cuts = np.array([[first, first + length] for first in firsts])
    queries = RunningSums(segment.features).vectors(cuts).astype(float)
    for row in range(0, len(windows), 7):
        clip = np.flatnonzero(windows.owners == windows.owners[row])
        behind = clip[clip >= row]
        apart = [
            np.linalg.norm(vectors[behind[min(hop, len(behind) - 1)]] - query)
            for hop, query in zip(hops, queries, strict=True)
        ]
        assert found.distances[row] == pytest.approx(np.mean(apart), rel=1e-4)
        assert 0 <= found.starts[row] < found.ends[row] <= windows.ends[clip[-1]] + 1e-6


def _hops(frames: int, scale: WindowScale) -> list[int]:
    """Where a query's windows begin: half a window or more apart, and the last that fits."""
    last = round((frames - scale.frames) / scale.hop)
    if last <= 0:
        return [0]
    step = max(scale.frames // 2 // scale.hop, int(np.ceil(last / (MAX_WINDOWS - 1))))
    return sorted({*range(0, last, step), last})


@pytest.mark.parametrize("length", [0.7, 2.0, 9.0])
def test_every_method_finds_a_piece_at_its_own_position(some: Clips, length: float) -> None:
    segment = segment_of(some.features["clip_0"], 12.0, 12.0 + length)
    both, anchor = by_both(some.view, segment, None, some.load)
    assert anchor is not None
    for found, tolerance in (
        (both, 0.0), (by_warping(some.ids, some.seconds, segment, None, some.load), 0.0),
        (by_windows(some.view, segment, None), 0.5),
    ):  # fmt: skip
        (best,), _ = merge_overlapping(found, 1)
        assert best.clip_id == "clip_0"
        assert (best.start, best.end) == pytest.approx((12.0, 12.0 + length), abs=tolerance + 1e-6)


def test_the_excluded_interval_has_no_hits(some: Clips) -> None:
    segment, excluded = (
        segment_of(some.features["clip_0"], 12, 14),
        ExcludedInterval("clip_0", 12.0, 14.0),
    )
    for found in (
        by_both(some.view, segment, excluded, some.load)[0],
        by_warping(some.ids, some.seconds, segment, excluded, some.load),
        by_windows(some.view, segment, excluded),
    ):
        own = found.owners == 0
        assert own.any()
        assert not (own & (found.starts < 14.0 - 1e-6) & (found.ends > 12.0 + 1e-6)).any()


def test_windows_follow_after_the_matches(some: Clips, monkeypatch: pytest.MonkeyPatch) -> None:
    for limit in ("MIN_PROPOSED", "MAX_PROPOSED"):
        monkeypatch.setattr(in_windows, limit, 2)
    segment = segment_of(some.features["clip_3"], 3, 5)
    found, anchor = by_both(some.view, segment, None, some.load)
    assert anchor is not None
    windows = len(by_windows(some.view, segment, None))
    warped = found.distances[:-windows]
    assert 0 < len(warped) < len(by_warping(some.ids, some.seconds, segment, None, some.load))
    assert anchor.end == warped.max()
    assert (found.distances[-windows:] >= anchor.end).all()
    assert set(found.owners[-windows:]) == {0, 1, 2, 3}


def test_an_anchor_keeps_the_same_parts_first(some: Clips, monkeypatch: pytest.MonkeyPatch) -> None:
    for limit in ("MIN_PROPOSED", "MAX_PROPOSED"):
        monkeypatch.setattr(in_windows, limit, 4)
    segment = segment_of(some.features["clip_3"], 3, 5)
    first, anchor = by_both(some.view, segment, None, some.load)
    before = [(part.key, part.distance) for part in merge_overlapping(first, 1000)[0]]
    near = {f"new_{i}": some.features["clip_3"][25:55] + np.float32(0.01 * i) for i in range(1, 6)}
    grown = Clips({**some.features, **near})
    for given, is_kept in ((anchor, True), (None, False)):
        found, _ = by_both(grown.view, segment, None, grown.load, given)
        after = [
            (part.key, part.distance)
            for part in merge_overlapping(found, 1000)[0]
            if not part.clip_id.startswith("new")
        ]
        assert (after == before) == is_kept


def test_matches_in_parts_of_clips_are_those_in_all_of_them(some: Clips) -> None:
    segment = segment_of(some.features["clip_0"], 12, 14)
    whole = by_warping(some.ids, some.seconds, segment, None, some.load)
    parts = matches_in(some.ids, some.seconds, [Region(0, 100, 160)], segment, None, some.load)
    assert set(_rows(parts)) & set(_rows(whole))
    assert ((parts.starts >= 10.0) & (parts.ends <= 16.0)).all()
    gone = matches_in(some.ids, some.seconds, [Region(0)], segment, None, lambda ids, name: {})
    assert len(gone) == 0


@pytest.mark.parametrize("frames", [1, 150, 10_000])
def test_few_frames_are_in_memory_at_a_time_and_the_matches_are_the_same(
    some: Clips, monkeypatch: pytest.MonkeyPatch, frames: int
) -> None:
    segment = segment_of(some.features["clip_0"], 12, 14)
    whole = by_warping(some.ids, some.seconds, segment, None, some.load)
    held: list[int] = []

    def load(clip_ids: Sequence[str], name: str) -> Mapping[str, FloatArray]:
        found = some.load(clip_ids, name)
        held.append(sum(len(one) for one in found.values()) if len(found) > 1 else 0)
        return found

    monkeypatch.setattr(matches, "MAX_FRAMES_AT_ONCE", frames)
    assert _rows(by_warping(some.ids, some.seconds, segment, None, load)) == _rows(whole)
    assert max(held) <= frames


def _rows(found: Candidates) -> list[tuple[int, float, float]]:
    columns = found.owners.tolist(), found.starts.tolist(), found.ends.tolist()
    return list(zip(*columns, strict=True))


def test_regions_that_touch_are_joined() -> None:
    regions = [
        Region(1, 0, 5),
        Region(0, 7, 9),
        Region(0, 0, 4),
        Region(0, 3, 7),
        Region(0, 12, 13),
    ]
    whole = merged(regions)
    assert whole == [Region(0, 0, 9), Region(0, 12, 13), Region(1, 0, 5)]
    assert all(one.clip < other.clip or one.stop < other.first for one, other in pairwise(whole))
