"""Trees of filters: how they are read, and the same clips in memory as in the database."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from typing import Any

import pytest

from app.errors import BadField
from app.search.index.filters import MAX_DEPTH, MAX_FILTERS, parse_filter
from app.search.index.vector_index import VectorIndex
from app.store.clips import listing
from app.store.clips.filter import ClipFilter
from app.store.database.ids import utc_now
from app.store.store import Store
from tests.search.stored_clips import AddClip

WALK, ADA = {"task": "walk"}, {"person": "ada"}
TREES: list[tuple[dict[str, Any], set[str]]] = [
    ({"any_of": [WALK, ADA]}, {"ada walk", "ada run", "bruno walk", "none walk"}),
    ({"all_of": [WALK, ADA]}, {"ada walk"}),
    ({"none_of": [WALK, ADA]}, {"bruno run", "none none"}),
    ({"none_of": [ADA]}, {"bruno walk", "bruno run", "none walk", "none none"}),
    ({"none_of": [{"none_of": [ADA]}]}, {"ada walk", "ada run"}),
    ({"where": {"any_of": [ADA, {"none_of": [{"task": ["walk", "run"]}]}]}, **WALK}, {"ada walk"}),
    ({"none_of": [{"max_duration": 2.5}]}, {"ada walk"}),
    ({"none_of": [{"min_speed": 1.0}], **ADA}, {"ada walk", "ada run"}),  # nobody has a speed
    ({"none_of": [{"all_of": [WALK, {"not_person": "ada"}]}], "task": "walk"}, {"ada walk"}),
    ({"any_of": [{"meta.age.min": 30}, {"word": "slow"}]}, {"ada walk", "ada run", "bruno run"}),
    ({"none_of": [{"meta.age.min": 30}], "person": "ada"}, {"ada run"}),
]


@pytest.fixture
def index(store: Store, add: AddClip) -> VectorIndex:
    for person in ("ada", "bruno"):
        for task in ("walk", "run"):
            labels: dict[str, Any] = {"person": person, "task": task}
            if labels == {**WALK, **ADA}:
                add("ada walk", duration=3.0, metadata={"age": 31}, **labels)
            else:
                add(f"{person} {task}", words=("slow",) if task == "run" else (), **labels)
    add("none walk", task="walk")
    add("none none")
    index = VectorIndex()
    index.catch_up(store)
    return index


def _found(store: Store, index: VectorIndex, given: dict[str, Any]) -> set[str]:
    """The names of the clips that pass, which are the same in memory and in the database."""
    asked = parse_filter(given)
    with store.read() as tx:
        listed = {clip.id: clip.name for clip in listing.list_clips(tx, asked).items}
        assert listing.count_clips(tx, asked) == len(listed)
    assert set(index.candidates(asked).ids) == set(listed)
    return set(listed.values())


@pytest.mark.parametrize(("given", "names"), TREES)
def test_memory_and_database_find_the_same_clips(
    store: Store, index: VectorIndex, given: dict[str, Any], names: set[str]
) -> None:
    assert _found(store, index, given) == names


def test_dates_are_bounds(store: Store, index: VectorIndex) -> None:
    hour = timedelta(hours=1)
    before, after = (utc_now() - hour).isoformat(), (utc_now() + hour).isoformat()
    assert len(_found(store, index, {"created_after": before})) == 6
    assert _found(store, index, {"created_after": after}) == set()
    assert len(_found(store, index, {"created_before": after})) == 6
    assert _found(store, index, {"none_of": [{"created_before": after}]}) == set()


def test_dates_are_utc_without_a_zone() -> None:
    read = parse_filter({"created_after": "2026-03-01", "created_before": "2026-03-01T12:00+02:00"})
    assert read.created_after == datetime(2026, 3, 1, tzinfo=UTC)
    assert read.created_before == datetime(2026, 3, 1, 10, tzinfo=UTC)


def _nested(depth: int) -> dict[str, Any]:
    return {"none_of": [_nested(depth - 1)]} if depth else WALK


@pytest.mark.parametrize(
    ("given", "location"),
    [
        ({"any_of": []}, "filter.any_of"),
        ({"any_of": WALK}, "filter.any_of"),
        ({"any_of": ["walk"]}, "filter.any_of"),
        ({"any_of": [WALK, {"tsak": "a"}]}, "filter.any_of.1.tsak"),
        ({"where": {"none_of": [{"min_speed": "a"}]}}, "filter.where.none_of.0.min_speed"),
        ({"where": [WALK]}, "filter.where"),
        ({"all_of": [WALK] * (MAX_FILTERS + 1)}, "filter.all_of"),
        (_nested(MAX_DEPTH + 1), "filter" + ".none_of.0" * MAX_DEPTH + ".none_of"),
        ({"created_after": "yesterday"}, "filter.created_after"),
        ({"created_before": 2026}, "filter.created_before"),
    ],
)
def test_each_bad_filter_of_a_tree_is_named(given: dict[str, Any], location: str) -> None:
    with pytest.raises(BadField) as refused:
        parse_filter(given)
    assert [place.location for place in refused.value.places] == [location]


def test_a_tree_of_the_largest_depth_is_read() -> None:
    assert parse_filter(_nested(MAX_DEPTH)) != ClipFilter()
