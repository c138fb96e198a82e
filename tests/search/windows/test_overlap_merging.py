"""Merging and paging places, against the greedy loop over all pairs."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.search.ranking.cursor import Position
from app.search.windows import overlap_merging as module
from app.search.windows.overlap_merging import (
    MAX_OVERLAP,
    Candidates,
    FoundInterval,
    merge_overlapping,
)

Listed = tuple[str, float, float, float]


def candidates(rows: list[tuple[int, float, float, float]], clips: int = 3) -> Candidates:
    """From (clip, start, end, distance); ids fall as numbers rise."""
    owners, starts, ends, distances = np.array(rows, dtype=float).reshape(-1, 4).T
    ids = np.array([f"clip_{clips - number}" for number in range(clips)], dtype=object)
    return Candidates(ids, owners.astype(int), starts, ends, distances)


def naive_merging(found: Candidates) -> list[Listed]:
    rows = sorted(
        (round(float(d), 9), str(found.ids[o]), float(s), float(e))
        for o, s, e, d in zip(found.owners, found.starts, found.ends, found.distances, strict=True)
    )
    kept: list[Listed] = []
    for distance, clip, start, end in rows:
        if not any(
            clip == other and min(end, e) - max(start, s) > MAX_OVERLAP * min(end - start, e - s)
            for other, s, e, _ in kept
        ):
            kept.append((clip, start, end, distance))
    return kept


def listed(found: list[FoundInterval]) -> list[Listed]:
    return [(part.clip_id, part.start, part.end, part.distance) for part in found]


@st.composite
def _some(draw: st.DrawFn) -> Candidates:
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    count = draw(st.integers(0, 120))
    starts = np.round(rng.uniform(0, 30, count), draw(st.sampled_from([0, 1])))
    lengths = rng.choice([0.5, 1.0, 4.0, 9.0], count)
    # few distances: many ties
    distances = rng.integers(0, draw(st.sampled_from([3, 1000])), count) / 7
    owners = rng.integers(0, 3, count)
    columns = (owners, starts, starts + lengths, distances)
    return candidates(list(zip(*columns, strict=True)))


@given(found=_some(), first_count=st.sampled_from([1, 5, 2048]))
@settings(max_examples=60, deadline=None)
def test_results_are_those_of_a_greedy_loop(found: Candidates, first_count: int) -> None:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "FIRST_COUNT", first_count)
        everything, more = merge_overlapping(found, 1000)
    assert listed(everything) == naive_merging(found)
    assert not more


@given(found=_some(), size=st.integers(1, 7))
@settings(max_examples=30, deadline=None)
def test_all_pages_together_are_all_results(found: Candidates, size: int) -> None:
    paged: list[FoundInterval] = []
    after: Position | None = None
    while True:
        page, more = merge_overlapping(found, size, after)
        paged += page
        if not more:
            break
        assert len(page) == size
        after = Position(len(paged), page[-1].distance, page[-1].key)
    assert listed(paged) == naive_merging(found)


def test_neighbors_that_hardly_overlap_are_two_results() -> None:
    found = candidates([(0, 0.0, 2.0, 0.1), (0, 1.7, 3.7, 0.2), (0, 3.0, 5.0, 0.3)])
    assert [part.start for part in merge_overlapping(found, 9)[0]] == [0.0, 1.7]


def test_no_result_is_farther_than_the_limit() -> None:
    found = candidates([(0, 0.0, 1.0, 0.1), (1, 0.0, 1.0, 0.2), (2, 0.0, 1.0, 0.3)])
    assert [p.distance for p in merge_overlapping(found, 9, max_distance=0.2)[0]] == [0.1, 0.2]


def test_a_result_has_the_index_of_its_candidate() -> None:
    found = candidates([(0, 5.0, 6.0, 0.9), (1, 2.0, 3.0, 0.5)])
    assert [part.index for part in merge_overlapping(found, 9)[0]] == [1, 0]
