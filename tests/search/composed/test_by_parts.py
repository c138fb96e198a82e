"""Rankings by several parts, compared with the same ranking measured all at once."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from app.numerics.arrays import FloatArray, IntArray
from app.search.composed.by_parts import Evidence, PartsRanking, SecondStage
from app.search.composed.likeness import Curve
from app.search.composed.surprise import Part
from app.search.example.fusion import SHORTLIST
from app.search.ranking.cursor import Anchor
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray
from tests.search.walking import walk

COUNT = 350
CURVE = Curve(0.5, 3.0)
PARTS = [Part(is_pooled=True), Part(2.0, is_pooled=True), Part(0.5, is_against=True)]


class Clips:
    """Clips with random distances to three examples, fast ones and exact ones; words are last."""

    def __init__(self, parts: list[Part] = PARTS) -> None:
        rng = np.random.default_rng(5)
        self.parts = parts
        self.ids: IdArray = np.array([f"c{i:03d}" for i in range(COUNT)], dtype=object)
        self.fast = rng.uniform(0.1, 2.0, size=(len(parts), COUNT))
        self.exact = self.fast + rng.uniform(0.0, 0.3, size=self.fast.shape)
        self.words = rng.uniform(0.0, 1.0, size=COUNT)
        self.measured: set[str] = set()

    def evidence(self) -> list[Evidence]:
        examples = [
            Evidence(part, CURVE.probabilities(fast, 1.0), self._second(row))
            for row, (part, fast) in enumerate(zip(self.parts, self.fast, strict=True))
        ]
        return [*examples, Evidence(Part(), self.words)]

    def ranking(self, anchor: Anchor | None = None) -> PartsRanking:
        return PartsRanking(self.ids, self.evidence(), anchor)

    def _second(self, row: int) -> SecondStage:
        def measured(ids: IdArray) -> LowerBounds:
            numbers = np.array([int(clip_id[1:]) for clip_id in ids])

            def measure(chosen: IntArray) -> FloatArray:
                self.measured.update(ids[chosen])
                return self.exact[row][numbers[chosen]]

            return LowerBounds(ids, self.fast[row][numbers], measure)

        return SecondStage(measured, lambda distances: CURVE.probabilities(distances, 1.0))

    def expected(self) -> list[str]:
        """The order of the shortlist, then of the others, by one formula and one sort each."""

        def distance(number: int, distances: FloatArray) -> float:
            first, second, third = (
                1.0 / (1.0 + (own / 0.5) ** 3.0) for own in distances[:, number]
            )
            odds = math.log(first / (1.0 - first)) + 2.0 * math.log(second / (1.0 - second))
            pool = 1.0 / (1.0 + math.exp(-odds / 3.0))
            return -(
                3.0 * math.log(pool) + 0.5 * math.log(1.0 - third) + math.log(self.words[number])
            )

        first = sorted(range(COUNT), key=lambda number: distance(number, self.fast))
        shortlist, others = first[:SHORTLIST], first[SHORTLIST:]
        again = sorted(shortlist, key=lambda number: distance(number, self.exact))
        return [f"c{number:03d}" for number in [*again, *others]]


@pytest.mark.parametrize("size", [7, 130, 1000])
def test_pages_are_those_of_all_clips_measured_at_once(size: int) -> None:
    clips = Clips()
    pages = walk(lambda after: clips.ranking(after.anchor if after else None), size)
    assert [clip_id for page in pages for clip_id in page.ids] == clips.expected()
    distances = np.concatenate([page.distances for page in pages])
    assert (np.diff(distances) >= 0).all()


def test_a_short_page_measures_few_clips() -> None:
    clips = Clips()
    clips.ranking().page(None, 5)
    assert 5 <= len(clips.measured) < SHORTLIST


def test_the_probabilities_of_a_hit_are_those_it_was_ranked_by() -> None:
    clips = Clips()
    ranking = clips.ranking()
    page = ranking.page(None, COUNT)
    best, last = int(page.ids[0][1:]), int(page.ids[-1][1:])
    for number, distances in ((best, clips.exact), (last, clips.fast)):
        expected = [*CURVE.probabilities(distances[:, number], 1.0), clips.words[number]]
        assert ranking.probabilities(f"c{number:03d}") == pytest.approx(expected)


def test_a_clip_that_was_deleted_meanwhile_is_no_hit() -> None:
    clips = Clips()
    gone = clips.expected()[0]
    clips.exact[:, int(gone[1:])] = np.inf
    page = clips.ranking().page(None, COUNT)
    assert gone not in page.ids
    assert len(page.ids) == COUNT - 1


def test_an_example_against_pushes_down_only_what_is_near_it() -> None:
    with_it, without = Clips([Part(), Part(is_against=True)]), Clips([Part()])
    without.fast, without.exact = with_it.fast[:1], with_it.exact[:1]
    places: dict[str, Any] = {
        name: {clip_id: place for place, clip_id in enumerate(one.ranking().page(None, COUNT).ids)}
        for name, one in (("with", with_it), ("without", without))
    }
    near = with_it.ids[np.argsort(with_it.fast[1])[:50]]
    assert np.mean([places["with"][one] - places["without"][one] for one in near]) > 50
