"""Groups of judged clips: by labels and by metadata."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from app import evaluate
from app.errors import BadField
from app.evaluate.grouping import MAX_GROUPS, NO_VALUE, Grouping, grouped
from app.evaluate.recognition.evaluation import judge_clips
from app.evaluate.recognition.methods import METHODS
from app.evaluate.recognition.rounds import LeftOut
from app.search.example.methods import Method
from app.services.library.library import Library
from tests.api.test_schemas import CLIP
from tests.evaluate.recognition.recognition_library import invented


@pytest.mark.parametrize(
    ("by", "group"),
    [
        ("person", "anna"),
        ("folder", "lab/anna"),
        ("meta.condition", "tired"),
        ("meta.age", "30"),
        ("meta.none", NO_VALUE),
    ],
)
def test_the_group_of_a_clip(by: str, group: str) -> None:
    grouping = Grouping.of(by)
    assert grouping is not None
    assert grouping.group(CLIP) == group
    assert (
        grouping.group(dataclasses.replace(CLIP, person=None, path=None, metadata={})) == NO_VALUE
    )


def test_an_unknown_grouping_is_refused() -> None:
    with pytest.raises(BadField, match=r"must be meta\.KEY or one of"):
        Grouping.of("persn")


def test_a_key_that_no_clip_has_is_refused() -> None:
    grouping = Grouping.of("meta.conditoin")
    assert grouping is not None
    assert grouping.groups([]) == []
    with pytest.raises(BadField, match=r"no clip has 'conditoin'.*their keys are age, condition"):
        grouping.groups([CLIP])
    with pytest.raises(BadField, match="they have no metadata"):
        grouping.groups([dataclasses.replace(CLIP, metadata={})])
    known = Grouping.of("meta.age")
    assert known is not None
    assert known.groups([CLIP, dataclasses.replace(CLIP, metadata={})]) == ["30", NO_VALUE]


def test_the_largest_groups_come_first_and_there_is_a_limit() -> None:
    assert grouped(["b", "a", "b"], [1, 2, 3]) == {"b": [1, 3], "a": [2]}
    assert (
        len(grouped([str(i) for i in range(MAX_GROUPS + 9)], range(MAX_GROUPS + 9))) == MAX_GROUPS
    )


def test_the_figures_of_groups_add_up(ready_library: Library) -> None:
    found = evaluate.judge_retrieval(ready_library, methods=[Method.VECTOR], by="person")
    (judged,) = found.methods
    assert sum(one.queries for one in judged.by_group.values()) == judged.figures.queries
    right = sum(one.nearest * one.queries for one in judged.by_group.values())
    assert np.isclose(right, judged.figures.nearest * judged.figures.queries)
    assert set(judged.by_group) == {"ada", "bruno", "chika"}


def test_the_shares_of_groups_add_up() -> None:
    clips = invented(persons=2, tasks=3, takes=4)
    groups = ["even" if i % 2 == 0 else "odd" for i in range(len(clips))]
    reported = dataclasses.replace(clips, reported=groups)
    found = judge_clips(reported, {"mean-motion": METHODS["mean-motion"]})
    judged = found.held_out[LeftOut.TAKE].methods[0]
    assert set(judged.by_group) == {"even", "odd"}
    assert sum(one.both.of for one in judged.by_group.values()) == judged.recognized.both.of
    assert sum(one.both.right for one in judged.by_group.values()) == judged.recognized.both.right
