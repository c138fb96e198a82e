"""Rankings are stable, and scores fall strictly with distance."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from app.search.ranking.cursor import Position
from app.search.ranking.ranking import Ranking, score
from tests.search.walking import walked

DISTANCES = st.lists(st.sampled_from([0.0, 1e-10, 0.5, 0.5 + 1e-9, 2.0, 2.0, 150.0]), max_size=30)


def _ids(count: int) -> np.ndarray:
    return np.array([f"clip_{(i * 7919) % 1000:03d}" for i in range(count)], dtype=object)


@given(DISTANCES)
def test_order_is_by_distance_then_id(distances: list[float]) -> None:
    ranked = Ranking(_ids(len(distances)), np.array(distances))
    keys = list(zip(ranked.distances, ranked.ids, strict=True))
    assert keys == sorted(keys)


@given(DISTANCES, st.floats(0.01, 100.0))
def test_scores_are_equal_only_if_distances_are_equal(distances: list[float], scale: float) -> None:
    ranked = Ranking(_ids(len(distances)), np.array(distances))
    scores = [score(float(d), scale) for d in ranked.distances]
    assert all(0.0 < s <= 1.0 for s in scores)
    for (near, a), (far, b) in zip(
        zip(ranked.distances, scores, strict=True),
        list(zip(ranked.distances, scores, strict=True))[1:],
        strict=False,
    ):
        assert (near < far) == (a > b)


@given(DISTANCES, st.integers(1, 7))
def test_all_pages_together_are_the_ranking(distances: list[float], size: int) -> None:
    ranked = Ranking(_ids(len(distances)), np.array(distances))
    assert walked(ranked, size) == list(ranked.ids)


def test_the_next_page_continues_after_the_last_clip_also_if_it_was_deleted() -> None:
    ranked = Ranking(np.array(["a", "c"], dtype=object), np.array([0.1, 0.3]))
    assert list(ranked.page(Position(1, 0.2, "b"), 5).ids) == ["c"]


def test_a_page_reports_whether_others_follow() -> None:
    ranked = Ranking(_ids(3), np.array([0.1, 0.3, 0.3]))
    assert [ranked.page(None, limit).more for limit in (1, 2, 3, 4)] == [True, True, False, False]
    assert not Ranking(_ids(0), np.zeros(0)).page(None, 1).more
