"""Groups and diverse orders compared with loops."""

from __future__ import annotations

import numpy as np
import pytest

from app.search.ranking import groups
from app.search.ranking.groups import diverse_order, firsts, in_pages
from app.search.ranking.ranking import Ranking


def _twin(scores: np.ndarray, likeness: np.ndarray, diversity: float) -> list[int]:
    """Carbonell and Goldstein's formula, one hit after the other."""
    order: list[int] = []
    while len(order) < len(scores):
        rest = [one for one in range(len(scores)) if one not in order]
        worth = [
            (1 - diversity) * scores[one]
            - diversity * max((likeness[one, before] for before in order), default=0.0)
            for one in rest
        ]
        order.append(rest[int(np.argmax(worth))])
    return order


@pytest.mark.parametrize("diversity", [0.0, 0.3, 0.7, 1.0])
def test_the_order_is_that_of_a_loop(diversity: float) -> None:
    rng = np.random.default_rng(3)
    scores = np.sort(rng.random(20))[::-1]
    half = rng.random((20, 20))
    likeness = (half + half.T) / 2
    found = diverse_order(scores, likeness, diversity)
    assert found.tolist() == _twin(scores, likeness, diversity)
    if diversity == 0.0:
        assert found.tolist() == list(range(20))


def test_the_first_of_each_group_is_kept_and_those_without_one_all() -> None:
    seen: set[int] = set()
    assert firsts(np.array([2, 2, -1, 0, -1, 0]), seen).tolist() == [0, 2, 3, 4]
    assert firsts(np.array([0, 1, -1]), seen).tolist() == [1, 2]


@pytest.mark.parametrize("limit", [1, 3, 100])
@pytest.mark.parametrize("farthest", [np.inf, 5.0, -1.0])
def test_pages_are_read_as_far_as_they_are_needed(
    limit: int, farthest: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(groups, "FIRST_READ", limit)
    distances = np.random.default_rng(4).integers(0, 12, size=40).astype(float)
    ids = np.array([f"clip_{n:02}" for n in range(40)], dtype=object)
    ranking = Ranking(ids, distances)
    parts = list(in_pages(ranking, farthest))
    found = [one for some, _ in parts for one in some]
    assert found == [
        one for one, far in zip(ranking.ids, ranking.distances, strict=True) if far <= farthest
    ]
    assert [len(some) for some, _ in parts] == [len(far) for _, far in parts]
