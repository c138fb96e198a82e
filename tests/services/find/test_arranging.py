"""Hits in groups, diverse hits, the least score, and facets."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import pytest

from app.errors import BadField
from app.services.find.arrangement import Arrangement, GroupBy
from app.services.find.by_parts import find_by_parts
from app.services.find.hits import Hit
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from tests.libraries import FindClip


@pytest.fixture
def query(clip_of: FindClip) -> ComposedQuery:
    example = Example("examples.0", QuerySource(clip_of("ada", "walk").id))
    return ComposedQuery([example], ["walk"], limit=100)


def _hits(lib: Library, query: ComposedQuery, **asked: Any) -> list[Hit]:
    """All hits, in pages of two."""
    query = replace(query, arrangement=Arrangement(**asked), limit=2)
    found = find_by_parts(lib, query)
    hits = list(found.items)
    while found.next is not None:
        found = find_by_parts(lib, replace(query, cursor=found.next))
        hits += found.items
    assert [hit.rank for hit in hits] == list(range(1, len(hits) + 1))
    return hits


@pytest.mark.parametrize("by", ["person", "task", "source"])
def test_the_best_hit_of_each_group_is_shown(
    ready_library: Library, query: ComposedQuery, by: str
) -> None:
    every = find_by_parts(ready_library, query).items
    best: dict[str | None, str] = {}
    for hit in every:
        best.setdefault(getattr(hit.clip, by), hit.clip.id)
    counts = Counter(getattr(hit.clip, by) for hit in every)
    found = _hits(ready_library, query, group_by=GroupBy(by))
    assert [hit.clip.id for hit in found] == list(best.values())
    for hit in found:
        assert hit.group is not None
        assert (hit.group.by, hit.group.value) == (by, getattr(hit.clip, by))
        assert hit.group.count == counts[getattr(hit.clip, by)]
        within = _hits(ready_library, query, group_by=GroupBy(by), group=hit.group.value)
        assert [one.clip.id for one in within] == [
            one.clip.id for one in every if getattr(one.clip, by) == hit.group.value
        ]


def test_clips_without_near_duplicates_are_groups_of_one(
    ready_library: Library, query: ComposedQuery
) -> None:
    found = _hits(ready_library, query, group_by=GroupBy.DUPLICATES)
    assert [hit.clip.id for hit in found] == [
        hit.clip.id for hit in find_by_parts(ready_library, query).items
    ]
    assert all(hit.group and (hit.group.value, hit.group.count) == (None, 1) for hit in found)


def test_only_hits_that_are_good_enough_are_shown(
    ready_library: Library, query: ComposedQuery
) -> None:
    every = find_by_parts(ready_library, query).items
    least = every[3].score
    good = [hit.clip.id for hit in every if hit.score >= least]
    assert [hit.clip.id for hit in _hits(ready_library, query, min_score=least)] == good
    grouped = _hits(ready_library, query, min_score=least, group_by=GroupBy.TASK)
    assert sum(hit.group.count for hit in grouped if hit.group) == len(good)
    facets = find_by_parts(
        ready_library,
        replace(query, arrangement=Arrangement(min_score=least), facets=("task", "duration")),
    ).facets
    assert facets is not None
    assert sum(count for _, count in facets["task"].values) == len(good)
    assert _hits(ready_library, query, min_score=1.0) == []


def test_diverse_hits_are_all_hits_in_another_order(
    ready_library: Library, query: ComposedQuery
) -> None:
    every = [hit.clip.id for hit in find_by_parts(ready_library, query).items]
    tasks = {hit.clip.id: hit.clip.task for hit in find_by_parts(ready_library, query).items}
    diverse = [hit.clip.id for hit in _hits(ready_library, query, diversity=0.9)]
    assert sorted(diverse) == sorted(every)
    assert diverse[0] == every[0]
    assert len({tasks[one] for one in diverse[:4]}) > len({tasks[one] for one in every[:2]})
    assert [hit.clip.id for hit in _hits(ready_library, query, diversity=0.9)] == diverse


def test_words_alone_can_be_arranged(ready_library: Library) -> None:
    asked = ComposedQuery(words=["walk"], limit=100)
    every = find_by_parts(ready_library, asked)
    found = find_by_parts(ready_library, replace(asked, facets=("person",)))
    assert [hit.clip.id for hit in found.items] == [hit.clip.id for hit in every.items]
    assert found.method == every.method
    unknown = replace(asked, words=["zzyzx"], facets=("person",))
    assert find_by_parts(ready_library, unknown).items == ()


@pytest.mark.parametrize(
    ("changes", "location"),
    [
        ({"arrangement": Arrangement(group="ada")}, "group"),
        ({"arrangement": Arrangement(diversity=1.5)}, "diversity"),
        ({"arrangement": Arrangement(min_score=-0.1)}, "min_score"),
        ({"facets": ["persons"]}, "facets"),
    ],
)
def test_wrong_arrangements_are_refused(
    ready_library: Library, query: ComposedQuery, changes: dict[str, Any], location: str
) -> None:
    with pytest.raises(BadField) as refused:
        find_by_parts(ready_library, replace(query, **changes))
    assert location in str(refused.value)
