"""Subsequence DTW against its slow, obvious twin, and on matches that are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.alignment import subsequence_dtw as module
from app.numerics.alignment.subsequence_dtw import Matches, subsequence_dtw
from app.numerics.arrays import FloatArray

Known = dict[tuple[int, int], tuple[float, int]]


def naive_matches(
    query: FloatArray, streams: list[FloatArray], less: float = 0.0
) -> dict[tuple[int, int], tuple[int, float]]:
    """Start and cost of each local minimum by (stream, end), cell by cell.

    less: by how much it has to be below the costs beside it; below zero, what it may be above.
    """
    found = {}
    for number, stream in enumerate(streams):
        table = [[_distance(q, stream, j) for j in range(len(stream))] for q in query]
        known: Known = {}
        last = [_cell(table, len(query) - 1, j, known) for j in range(len(stream))]
        costs = [np.inf, *(cost for cost, _ in last), np.inf]
        for j, (cost, start) in enumerate(last):
            if np.isfinite(cost) and min(costs[j], costs[j + 2]) > cost + less:
                found[number, j + 1] = start, cost / len(query)
    return found


def _cell(cost: list[list[float]], i: int, j: int, known: Known) -> tuple[float, int]:
    """Total cost and start of the best path to a cell, by the recursion as it is written."""
    if i == -1 and j >= -1:
        return 0.0, j + 1
    if i < 0 or j < 0:
        return np.inf, 0
    if (i, j) not in known:
        total, start = _cell(cost, i - 1, j - 1, known)
        ways = [(total + cost[i][j], start)]
        if j >= 1:
            total, start = _cell(cost, i - 1, j - 2, known)
            ways.append((total + (cost[i][j - 1] + cost[i][j]) / 2, start))
        if i >= 1:
            total, start = _cell(cost, i - 2, j - 1, known)
            ways.append((total + cost[i - 1][j] + cost[i][j], start))
        known[i, j] = min(ways, key=lambda way: way[0])
    return known[i, j]


def _distance(frame: FloatArray, stream: FloatArray, column: int) -> float:
    """To the lines from a column half-way to the columns beside it."""
    here = stream[column]
    found = [float(np.linalg.norm(frame - here))]
    for beside in (column - 1, column + 1):
        if 0 <= beside < len(stream) and np.any(stream[beside] != here):
            line = stream[beside] - here
            along = np.clip((frame - here) @ line / (line @ line), 0.0, 0.5)
            found.append(float(np.linalg.norm(frame - here - along * line)))
    return min(found)


def _told(found: Matches) -> list[tuple[int, int, int]]:
    return list(
        zip(found.streams.tolist(), found.starts.tolist(), found.ends.tolist(), strict=True)
    )


@given(
    n=st.integers(1, 9),
    lengths=st.lists(st.integers(1, 60), min_size=1, max_size=5),
    dimensions=st.sampled_from([5, 9]),
    cells=st.sampled_from([10, 300, 4_000_000]),
    seed=st.integers(0, 10_000),
)
@settings(max_examples=25, deadline=None, derandomize=True)
def test_matches_are_those_of_a_naive_search_in_pieces_of_any_size(
    n: int, lengths: list[int], dimensions: int, cells: int, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    query = rng.normal(size=(n, dimensions))
    streams = [rng.normal(size=(m, dimensions)) for m in lengths]
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(module, "MAX_CELLS_AT_ONCE", cells)
        found = subsequence_dtw(query, streams)
    # a query frame nearest to the point half-way between two frames is as near to either: of
    # matches that differ by that alone rounding decides
    surely, perhaps = (naive_matches(query, streams, less) for less in (1e-4, -1e-4))
    told = {(stream, end): start for stream, start, end in _told(found)}
    assert surely.keys() <= told.keys() <= perhaps.keys()
    for (place, start), cost in zip(told.items(), found.costs, strict=True):
        assert abs(start - perhaps[place][0]) <= 1
        np.testing.assert_allclose(cost, perhaps[place][1], rtol=1e-4)


@pytest.mark.parametrize("factor", [0.6, 0.9, 1.0, 1.1, 1.7])
def test_a_piece_at_another_speed_is_matched_exactly(
    factor: float,
) -> None:
    rng = np.random.default_rng(3)
    query = np.cumsum(rng.normal(size=(40, 4)), axis=0)
    times = np.linspace(0, 39, round(40 * factor))
    played = np.stack([np.interp(times, np.arange(40), column) for column in query.T], axis=1)
    around = np.cumsum(rng.normal(size=(500, 4)), axis=0) + 30
    stream = np.concatenate([around[:201], played, around[201:]])
    found = subsequence_dtw(query, [stream])
    best = int(np.argmin(found.costs))
    assert abs(found.starts[best] - 201) <= 1
    assert abs(found.ends[best] - (201 + len(played))) <= 1


def test_the_times_of_the_samples_do_not_matter() -> None:
    times = np.arange(0, 60, 0.5)
    curve = np.cumsum(np.random.default_rng(7).normal(size=(60, 6)), axis=0)
    fine = np.stack([np.interp(times, np.arange(60), column) for column in curve.T], axis=1)
    query, stream = fine[41:81:2], fine[::2]
    found = subsequence_dtw(query, [stream])
    best = int(np.argmin(found.costs))
    assert found.costs[best] < 1e-3
    assert (found.starts[best], found.ends[best]) in [(20, 40), (21, 41), (20, 41)]


def test_every_copy_of_the_query_is_a_match_of_cost_zero() -> None:
    rng = np.random.default_rng(4)
    query = rng.normal(size=(12, 82)).astype(np.float32)
    gaps = [rng.normal(size=(m, 82)).astype(np.float32) for m in (5, 30, 17)]
    streams = [np.concatenate([gaps[0], query, gaps[1], query]), gaps[2], query]
    found = subsequence_dtw(query, streams)
    exact = np.flatnonzero(found.costs == 0.0)
    assert [_told(found)[i] for i in exact] == [(0, 5, 17), (0, 47, 59), (2, 0, 12)]


def test_a_match_is_between_half_and_twice_as_long_as_the_query() -> None:
    rng = np.random.default_rng(5)
    found = subsequence_dtw(rng.normal(size=(10, 2)), [rng.normal(size=(400, 2))])
    lengths = found.ends - found.starts
    assert (lengths.min(), lengths.max()) >= (5, 10)
    assert lengths.max() <= 20


def test_too_short_streams_and_no_streams() -> None:
    query = np.ones((10, 2))
    for streams in ([], [np.zeros((4, 2))], [np.zeros((0, 2)), np.zeros((1, 2))]):
        found = subsequence_dtw(query, streams)
        assert _told(found) == []
        assert found.costs.shape == (0,)
    with pytest.raises(ValueError, match="empty"):
        subsequence_dtw(np.zeros((0, 2)), [np.zeros((5, 2))])
