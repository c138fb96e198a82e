"""Filters as clients send them."""

from __future__ import annotations

from typing import Any

import pytest

from app.errors import BadField
from app.search.index.filters import parse_filter
from app.store.clips.filter import ClipFilter
from app.store.clips.measures import MEASURES


def test_an_empty_filter_selects_all_clips() -> None:
    assert parse_filter(None) == parse_filter({}) == ClipFilter()


def test_a_string_is_one_value_and_an_array_is_any_of_its_values() -> None:
    read = parse_filter({"person": "ada", "task": ["walk", "run"], "word": "Walk"})
    assert (read.person, read.task, read.word) == (("ada",), ("walk", "run"), ("walk",))


def test_labels_are_compared_in_their_stored_form() -> None:
    read = parse_filter({"word": ["left leg", " High-Kick "], "person": " Jose\u0301"})
    assert (read.word, read.person) == (("left_leg", "high_kick"), ("Jos\u00e9",))


def test_not_conditions_are_read_like_the_others() -> None:
    read = parse_filter({"not_task": "walk", "not_word": [" Left Leg "], "not_person": ["a", "b"]})
    assert read.not_task == ("walk",)
    assert read.not_word == ("left_leg",)
    assert read.not_person == ("a", "b")


def test_durations_are_numbers_of_seconds() -> None:
    read = parse_filter({"min_duration": 1, "max_duration": 2.5})
    assert (read.min_duration, read.max_duration) == (1.0, 2.5)


def test_every_measure_has_a_least_and_a_largest_value() -> None:
    for name in MEASURES:
        read = parse_filter({f"min_{name}": 1, f"max_{name}": 2.5})
        assert list(read.ranges()) == [(name, 1.0, 2.5)]
        assert list(parse_filter({f"max_{name}": 0}).ranges()) == [(name, None, 0.0)]


@pytest.mark.parametrize(
    ("given", "location"),
    [
        ({"min_speed": "fast"}, "filter.min_speed"),
        ({"min_height": 1}, "filter.min_height"),
        ({"persons": "ada"}, "filter.persons"),
        ({"state": "failed"}, "filter.state"),
        ({"person": 3}, "filter.person"),
        ({"task": []}, "filter.task"),
        ({"not_task": []}, "filter.not_task"),
        ({"not_name": "a"}, "filter.not_name"),
        ({"not_min_duration": 1}, "filter.not_min_duration"),
        ({"task": ["walk", None]}, "filter.task"),
        ({"min_duration": "1"}, "filter.min_duration"),
        ({"max_duration": True}, "filter.max_duration"),
        ({"max_duration": float("nan")}, "filter.max_duration"),
        ({"min_duration": -1}, "filter.min_duration"),
    ],
)
def test_each_bad_key_is_named(given: dict[str, Any], location: str) -> None:
    with pytest.raises(BadField) as refused:
        parse_filter(given)
    assert [place.location for place in refused.value.places] == [location]
