"""Partial warping against every path tried by recursion, and what it says of crops and tempos."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.alignment import cost_tables, partial_dtw
from app.numerics.alignment.partial_dtw import MAX_STEP, Limits, partial_distances
from app.numerics.arrays import FloatArray


def naive_inside(whole: FloatArray, other: FloatArray) -> float:
    """The slow twin: each frame of `whole` is matched, the partner never goes back."""
    points = [*other[:1]]
    for left in range(len(other) - 1):
        before = other[left - 1] if left else 2 * other[0] - other[1]
        after = other[left + 2] if left + 2 < len(other) else 2 * other[-1] - other[-2]
        cubic = np.polyfit([-1, 0, 1, 2], [before, other[left], other[left + 1], after], 3)
        points += [0.5 ** np.arange(3, -1, -1) @ cubic, other[left + 1]]
    cost = np.linalg.norm(whole[:, None] - np.array(points), axis=2)

    def cheapest(i: int, j: int) -> float:
        if i == 0:
            return float(cost[0, j])
        before = [cheapest(i - 1, j - step) for step in range(MAX_STEP + 1) if step <= j]
        return float(cost[i, j]) + min(before)

    return min(cheapest(len(whole) - 1, j) for j in range(len(points))) / len(whole)


@given(
    n=st.integers(1, 4), lengths=st.lists(st.integers(1, 4), max_size=4), seed=st.integers(0, 99)
)
@settings(max_examples=40, deadline=None)
def test_both_distances_equal_a_naive_computation(n: int, lengths: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    query, candidates = rng.normal(size=(n, 3)), [rng.normal(size=(m, 3)) for m in lengths]
    found = partial_distances(query, candidates)
    inside = [naive_inside(query, one) for one in candidates]
    around = [naive_inside(one, query) for one in candidates]
    np.testing.assert_allclose(found.inside, inside, rtol=1e-5)
    np.testing.assert_allclose(found.around, around, rtol=1e-5)


def test_many_batches_give_what_one_gives(monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng(1)
    query = rng.normal(size=(9, 3))
    candidates = [rng.normal(size=(m, 3)) for m in rng.integers(1, 30, size=40)]
    at_once = partial_distances(query, candidates)
    monkeypatch.setattr(cost_tables, "MAX_CELLS_AT_ONCE", 500)
    in_batches = partial_distances(query, candidates)
    np.testing.assert_allclose(in_batches.inside, at_once.inside, rtol=1e-5)
    np.testing.assert_allclose(in_batches.around, at_once.around, rtol=1e-5)


@given(
    lengths=st.lists(st.integers(1, 30), max_size=9),
    inside=st.floats(0.0, 3.0),
    seed=st.integers(0, 999),
)
@settings(max_examples=40, deadline=None)
def test_limits_change_no_distance_below_them(lengths: list[int], inside: float, seed: int) -> None:
    rng = np.random.default_rng(seed)
    query = rng.normal(size=(9, 3))
    candidates = [rng.uniform(0, 2) * rng.normal(size=(m, 3)) for m in lengths]
    around = rng.uniform(0, 3, size=len(lengths))
    every = partial_distances(query, candidates)
    limited = partial_distances(query, candidates, Limits(inside, around))
    for got, full, limit in (
        (limited.inside, every.inside, np.full(len(lengths), inside)),
        (limited.around, every.around, around),
    ):
        assert got[full < limit].tolist() == full[full < limit].tolist()
        assert (np.isinf(got) | (got == full)).all()


def _curve(times: FloatArray) -> FloatArray:
    return np.column_stack([np.sin(times), np.cos(0.7 * times), np.sin(0.3 * times)])


def test_a_crop_is_inside_and_a_repetition_is_around() -> None:
    whole = _curve(np.arange(0, 9, 0.1))
    found = partial_distances(whole, [whole[20:60], np.concatenate([whole, whole])])
    assert found.around[0] == 0.0 < 0.3 < found.inside[0]
    assert found.inside[1] == 0.0


@pytest.mark.parametrize("tempo", [0.4, 0.5, 1.5, 2.0])
def test_tempo_hardly_matters(tempo: float) -> None:
    query, played = _curve(np.arange(0, 9, 0.1)), _curve(np.arange(0, 9, 0.1 * tempo))
    found = partial_distances(query, [played, _curve(np.arange(4, 13, 0.1) + 2)])
    nearest = np.minimum(found.inside, found.around)
    assert nearest[0] < 0.03 < 0.2 < nearest[1]


def test_long_sequences_are_thinned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(partial_dtw, "MAX_FRAMES", 50)
    long = _curve(np.arange(0, 9, 0.01))
    thinned = partial_distances(long, [long[:450]])
    assert thinned.around[0] < 0.1
    assert thinned.inside[0] > 0.2


def test_an_empty_sequence_is_refused() -> None:
    with pytest.raises(ValueError, match="empty"):
        partial_distances(np.zeros((0, 2)), [np.zeros((1, 2))])
    with pytest.raises(ValueError, match="empty"):
        partial_distances(np.zeros((1, 2)), [np.zeros((0, 2))])
