"""Pages of a ranking that is measured as far as one looks are those of all of it."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from app.numerics.arrays import FloatArray, IntArray
from app.search.ranking.cursor import Position
from app.search.ranking.lower_bounds import MIN_MEASURED, LowerBoundRanking, LowerBounds
from app.search.ranking.ranking import Ranking

DISTANCES = st.lists(st.sampled_from([0.0, 0.5, 0.5 + 1e-9, 2.0, 2.0, 7.0, np.inf]), max_size=60)


def _ids(count: int) -> np.ndarray:
    return np.array([f"clip_{(i * 7919) % 1000:03d}" for i in range(count)], dtype=object)


@given(DISTANCES, st.integers(1, 9), st.integers(0, 10_000))
@settings(max_examples=100, deadline=None)
def test_pages_are_the_same_as_if_all_clips_were_measured(
    distances: list[float], size: int, seed: int
) -> None:
    truth = np.array(distances)
    shares = np.random.default_rng(seed).uniform(0, 1, size=len(truth)).round()
    finite = np.isfinite(truth)
    least = np.where(finite, truth, 1.0) * shares
    every = Ranking(_ids(len(truth))[finite], truth[finite])
    after, seen = None, 0
    while True:
        # each page is asked of a new one, as each request is
        found = LowerBoundRanking(LowerBounds(_ids(len(truth)), least, lambda rows: truth[rows]))
        page, expected = found.page(after, size), every.page(after, size)
        assert list(page.ids) == list(expected.ids)
        assert page.distances.tolist() == expected.distances.tolist()
        assert page.more == expected.more
        if not page.more:
            break
        seen += len(page.ids)
        after = Position(seen, float(page.distances[-1]), str(page.ids[-1]))


def test_each_clip_is_measured_once_and_few_clips_if_bounds_are_tight() -> None:
    rng = np.random.default_rng(1)
    truth = rng.uniform(1.0, 9.0, size=300)
    looked: list[int] = []

    def measure(rows: IntArray) -> FloatArray:
        looked.extend(rows.tolist())
        return truth[rows]

    found = LowerBoundRanking(LowerBounds(_ids(300), 0.9 * truth, measure))
    found.page(None, 10)
    assert found.measured == len(looked) <= 2 * MIN_MEASURED + 10
    assert found.end is None
    found.page(None, 300)
    assert sorted(looked) == list(range(300))
    assert found.end == float(truth.max().round(9))


def test_no_clip_is_farther_than_the_end() -> None:
    truth = np.array([1.0, 5.0, 3.0])
    found = LowerBoundRanking(
        LowerBounds(_ids(3), truth, lambda rows: truth[rows]), max_distance=2.5
    )
    assert sorted(found.page(None, 3).distances.tolist()) == [1.0, 2.5, 2.5]
    assert found.end == 2.5


def test_a_ranking_without_clips_has_an_end() -> None:
    found = LowerBoundRanking(LowerBounds(_ids(0), np.zeros(0), lambda rows: np.zeros(len(rows))))
    assert (len(found.page(None, 5).ids), found.end) == (0, 0.0)
