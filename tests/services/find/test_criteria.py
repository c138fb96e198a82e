"""Poses in order, rhythms and parts of bodies, over a library that a worker has analyzed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.errors import BadField
from app.search.composed.body_parts import BodyPart
from app.services.find.by_parts import find_by_parts
from app.services.find.hits import Hits
from app.services.find.queries import ComposedQuery, Example, PoseQuery, PoseSequence, Rhythm
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from tests.libraries import FindClip


def _ids(hits: Hits) -> list[str]:
    return [hit.clip.id for hit in hits.items]


def test_a_sequence_of_poses_finds_the_clip_it_comes_from(
    ready_library: Library, clip_of: FindClip
) -> None:
    bow = clip_of("ada", "bow")
    duration = bow.duration or 0.0
    times = (0.0, 0.5 * duration, duration - 0.1)
    poses = [PoseQuery(QuerySource(bow.id), time) for time in times]
    asked = ComposedQuery(poses=PoseSequence(poses), include_self=True, limit=100)
    found = find_by_parts(ready_library, asked)
    assert found.items[0].clip.id == bow.id
    assert found.items[0].score > 0.99
    assert [hit.clip.task for hit in found.items[:3]] == ["bow"] * 3
    assert [part.part for part in found.items[0].parts] == ["poses"]
    without = find_by_parts(ready_library, replace(asked, include_self=False))
    assert bow.id not in _ids(without)
    against = replace(asked, poses=PoseSequence(poses, is_against=True), words=["bow"])
    assert find_by_parts(ready_library, against).items[-1].clip.task == "bow"
    paged = find_by_parts(ready_library, replace(asked, limit=2))
    rest = find_by_parts(ready_library, replace(asked, limit=100, cursor=paged.next))
    assert _ids(paged) + _ids(rest) == _ids(found)


def test_a_rhythm_finds_clips_that_repeat_themselves_so_fast(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk = clip_of("ada", "walk")
    ready_library.index.catch_up(ready_library.store)
    labels = ready_library.index.state[1].labels
    number = labels.numbers(np.array([walk.id], dtype=object))[0]
    rate = 60.0 / float(labels.measured("cycle_time")[number])
    found = find_by_parts(ready_library, ComposedQuery(rhythm=Rhythm(rate, 0.05), limit=100))
    scores = {hit.clip.id: hit.score for hit in found.items}
    assert scores[walk.id] == pytest.approx(labels.measured("cyclicity")[number], abs=1e-3)
    far = find_by_parts(ready_library, ComposedQuery(rhythm=Rhythm(rate * 1.4, 0.05), limit=100))
    assert {hit.clip.id: hit.score for hit in far.items}[walk.id] < 0.01


@pytest.mark.parametrize("part", list(BodyPart))
def test_a_part_of_the_body_finds_the_same_motion(
    ready_library: Library, clip_of: FindClip, part: BodyPart
) -> None:
    kick = clip_of("ada", "kick")
    example = Example("examples.0", QuerySource(kick.id), body_part=part)
    asked = ComposedQuery([example], include_self=True, limit=100)
    found = find_by_parts(ready_library, asked)
    assert found.items[0].clip.id == kick.id
    assert found.items[0].score > 0.99
    if part is BodyPart.LEGS:
        assert [hit.clip.task for hit in found.items[:2]] == ["kick"] * 2
    paged = find_by_parts(ready_library, replace(asked, limit=3))
    rest = find_by_parts(ready_library, replace(asked, cursor=paged.next))
    assert _ids(paged) + _ids(rest) == _ids(found)
    whole = find_by_parts(
        ready_library, replace(asked, examples=[replace(example, body_part=None)])
    )
    assert [hit.score for hit in whole.items[1:]] != [hit.score for hit in found.items[1:]]


@pytest.mark.parametrize(
    ("changes", "location"),
    [
        ({"poses": PoseSequence([])}, "poses"),
        ({"poses": PoseSequence([PoseQuery()])}, "poses.sequence.0.positions"),
        ({"rhythm": Rhythm(0.0)}, "rhythm.cycles_per_minute"),
        ({"rhythm": Rhythm(60.0, 0.0)}, "rhythm.tolerance"),
        ({"rhythm": Rhythm(60.0, weight=0.0)}, "rhythm.weight"),
        ({"rhythm": Rhythm(60.0, is_against=True)}, "examples"),
    ],
)
def test_wrong_poses_and_rhythms_are_refused(
    ready_library: Library, changes: dict[str, Any], location: str
) -> None:
    with pytest.raises(BadField) as refused:
        find_by_parts(ready_library, ComposedQuery(**changes))
    assert location in [place.location for place in refused.value.places]
