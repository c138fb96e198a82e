"""Searches by learned metrics over a library that a worker has analyzed and fitted."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from app.demo import DemoClip, demo_clips
from app.errors import BadField, ModelNotFitted, PageNotFound
from app.search.example.methods import LEARNED, Method
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.hits import Hits
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.training import models
from app.services.training.fit import fit_library
from app.store.clips.record import ClipRecord
from tests.libraries import FindClip, settings_for, upload, work

TASK, PERSON = Method.METRIC_TASK, Method.METRIC_PERSON


def test_the_same_task_comes_first_and_the_same_person_comes_first(
    ready_library: Library, ready_clips: list[ClipRecord]
) -> None:
    for clip in ready_clips:
        tasks = find.find_motion(
            ready_library, MotionQuery(QuerySource(clip.id), method=TASK, limit=2)
        )
        assert [hit.clip.task for hit in tasks.items] == [clip.task] * 2
        people = find.find_motion(
            ready_library, MotionQuery(QuerySource(clip.id), method=PERSON, limit=2)
        )
        assert [hit.clip.person for hit in people.items] == [clip.person] * 2


def test_metrics_find_a_style_in_other_tasks_and_a_task_in_other_styles(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk = clip_of("ada", "walk")
    style = MotionQuery(QuerySource(walk.id), method=PERSON, filter={"not_task": "walk"}, limit=3)
    found = [(h.clip.person, h.clip.task) for h in find.find_motion(ready_library, style).items]
    assert {person for person, _ in found} == {"ada"}
    assert {task for _, task in found} == {"wave", "kick", "bow"}
    one = MotionQuery(QuerySource(walk.id), method=PERSON, filter={"task": "kick"}, limit=1)
    assert find.find_motion(ready_library, one).items[0].clip.id == clip_of("ada", "kick").id
    task = MotionQuery(QuerySource(walk.id), method=TASK, filter={"not_person": "ada"}, limit=2)
    found = [(h.clip.person, h.clip.task) for h in find.find_motion(ready_library, task).items]
    assert set(found) == {("bruno", "walk"), ("chika", "walk")}


@pytest.mark.parametrize("method", sorted(LEARNED))
def test_scores_are_probabilities_and_higher_for_the_same_label(
    ready_library: Library, ready_clips: list[ClipRecord], method: Method
) -> None:
    same, other = [], []
    for clip in ready_clips:
        hits = find.find_motion(
            ready_library, MotionQuery(QuerySource(clip.id), method=method, limit=100)
        )
        for hit in hits.items:
            is_same = getattr(hit.clip, method.removeprefix("metric-")) == getattr(
                clip, method.removeprefix("metric-")
            )
            (same if is_same else other).append(hit.score)
    assert min(same) > sum(other) / len(other)
    assert 0 < min(other) < max(same) <= 1


def test_learned_metrics_do_not_search_parts_of_clips(
    ready_library: Library, clip_of: FindClip
) -> None:
    asked = MotionQuery(QuerySource(clip_of("ada", "walk").id), method=TASK, scope="windows")
    with pytest.raises(BadField, match="method"):
        find.find_motion(ready_library, asked)


@pytest.fixture
def growing(tmp_path: Path) -> Iterator[Library]:
    """Two persons' clips of three tasks, ready and fitted; clips may be added."""
    opened = Library.open(settings_for(tmp_path, refit_growth=1e9))
    for clip in demo_clips(("ada", "bruno"), ("walk", "wave", "kick"), takes=1):
        upload(opened, clip)
    work(opened.settings)
    fit_library(opened.store)
    yield opened
    opened.close()


def test_new_clips_are_found_without_a_fit_and_a_fit_ends_old_cursors(growing: Library) -> None:
    (new,) = demo_clips(("elin",), ("kick",), takes=1)

    def search(limit: int = 2, cursor: str | None = None) -> Hits:
        query = MotionQuery(
            QuerySource(content=io.BytesIO(new.content)), method=TASK, include_self=True
        )
        return find.find_motion(growing, replace(query, limit=limit, cursor=cursor))

    first = search()
    assert [hit.clip.task for hit in first.items] == ["kick", "kick"]
    added = upload(growing, new).clip
    work(growing.settings)
    best = search(1).items[0]
    assert (best.clip.id, best.distance) == (added.id, pytest.approx(0, abs=1e-4))
    clips.delete_clip(growing, added.id)
    clips.update_clip(growing, first.items[0].clip.id, {"task": "high kick"})
    again = search()
    assert [hit.clip.id for hit in again.items] == [hit.clip.id for hit in first.items]
    assert again.items[0].clip.task == "high kick"
    rest = search(100, again.next).items
    assert [hit.rank for hit in rest] == [3, 4, 5, 6]
    fit_library(growing.store)
    with pytest.raises(PageNotFound):
        search(2, again.next)


@pytest.mark.parametrize("method", sorted(LEARNED))
def test_without_labels_there_is_no_model_and_the_error_says_why(
    lib: Library, some_demo_clips: list[DemoClip], method: Method
) -> None:
    made = [
        upload(lib, demo, person="ada", task="all the same").clip for demo in some_demo_clips[:3]
    ]
    work(lib.settings)
    with pytest.raises(ModelNotFitted):
        find.find_motion(lib, MotionQuery(QuerySource(made[0].id), method=method))
    models.request_fit(lib)
    work(lib.settings)
    with pytest.raises(ModelNotFitted, match="two clips each"):
        find.find_motion(lib, MotionQuery(QuerySource(made[0].id), method=method))
    reasons = {one.kind: one.reason for one in models.list_unfitted(lib)}
    assert "two clips each" in reasons[method.value]
    assert "words" not in reasons


def test_the_person_metric_is_refused_if_recognizing_persons_is_switched_off(
    tmp_path: Path, some_demo_clips: list[DemoClip]
) -> None:
    lib = Library.open(settings_for(tmp_path, recognize_persons=False))
    try:
        made = [upload(lib, demo).clip for demo in some_demo_clips[:8]]
        models.request_fit(lib)
        work(lib.settings)
        found = find.find_motion(lib, MotionQuery(QuerySource(made[0].id), method=TASK, limit=1))
        assert found.items[0].clip.task == made[0].task
        with pytest.raises(ModelNotFitted, match="switched off"):
            find.find_motion(lib, MotionQuery(QuerySource(made[0].id), method=PERSON))
    finally:
        lib.close()
