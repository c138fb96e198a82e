"""Searches over a library that a worker has analyzed."""

from __future__ import annotations

import io
from typing import Any

import pytest

from app.demo import DemoClip
from app.errors import (
    BadField,
    ClipNotFound,
    ClipNotReady,
    EmptyFile,
    ModelNotFitted,
    PageNotFound,
    Unreadable,
)
from app.search.example.methods import Method
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.hits import Hits
from app.services.find.queries import WORD_MODES, MotionQuery, WordQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from tests.libraries import FindClip
from tests.queries import motion_query

METHODS = list(Method)


def _all_pages(lib: Library, size: int, **query: Any) -> list[Hits]:
    pages = [find.find_motion(lib, motion_query(limit=size, **query))]
    while pages[-1].next is not None:
        pages.append(
            find.find_motion(lib, motion_query(limit=size, cursor=pages[-1].next, **query))
        )
    return pages


@pytest.mark.parametrize("method", METHODS)
def test_every_clip_is_ranked_and_scores_fall_with_distance(
    ready_library: Library, ready_clips: list[ClipRecord], method: Method
) -> None:
    query = ready_clips[0]
    hits = find.find_motion(
        ready_library, MotionQuery(QuerySource(query.id), method=method, limit=100)
    )
    assert {hit.clip.id for hit in hits.items} == {c.id for c in ready_clips} - {query.id}
    assert [hit.rank for hit in hits.items] == list(range(1, len(hits.items) + 1))
    for near, far in zip(hits.items, hits.items[1:], strict=False):
        assert near.distance <= far.distance
        assert (near.distance < far.distance) == (near.score > far.score)
    assert all(0 <= hit.score <= 1 for hit in hits.items)
    assert hits.method == method.value
    assert hits.next is None


@pytest.mark.parametrize("method", METHODS)
def test_all_pages_together_are_the_whole_ranking(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    query = {"clip_id": clip_of("ada", "walk").id, "method": method}
    whole = find.find_motion(ready_library, motion_query(limit=100, **query)).items
    paged = [hit for page in _all_pages(ready_library, 4, **query) for hit in page.items]
    assert [(h.rank, h.clip.id, h.distance) for h in paged] == [
        (h.rank, h.clip.id, h.distance) for h in whole
    ]


@pytest.mark.parametrize("method", METHODS)
def test_a_filter_is_applied_before_the_ranking(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    query = {"clip_id": clip_of("ada", "walk").id, "method": method}
    conditions = {"task": ["kick", "bow"], "person": "bruno"}
    hits = find.find_motion(ready_library, motion_query(limit=2, filter=conditions, **query))
    assert {(h.clip.person, h.clip.task) for h in hits.items} == {
        ("bruno", "kick"),
        ("bruno", "bow"),
    }


def test_similar_motions_are_found_first(ready_library: Library, clip_of: FindClip) -> None:
    for task in ("walk", "wave", "kick", "bow"):
        hits = find.find_motion(
            ready_library, MotionQuery(QuerySource(clip_of("bruno", task).id), limit=1)
        )
        assert [hit.clip.task for hit in hits.items] == [task]


@pytest.mark.parametrize("method", METHODS)
def test_a_clip_finds_itself_only_on_request(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    query = clip_of("chika", "wave")
    asked = MotionQuery(QuerySource(query.id), method=method, include_self=True, limit=1)
    best = find.find_motion(ready_library, asked).items[0]
    assert best.clip.id == query.id
    assert best.distance == pytest.approx(0, abs=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_an_upload_finds_the_same_stored_clip_and_is_not_stored(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip, method: Method
) -> None:
    demo = next(c for c in some_demo_clips if (c.person, c.task) == ("ada", "kick"))
    files = set(ready_library.store.files)
    source = QuerySource(content=io.BytesIO(demo.content))
    asked = MotionQuery(source, method=method, limit=1, include_self=True)
    best = find.find_motion(ready_library, asked).items[0]
    assert best.clip.id == clip_of("ada", "kick").id
    assert best.distance == pytest.approx(0, abs=1e-4)
    assert set(ready_library.store.files) == files


def test_a_part_of_a_clip_is_described_by_itself(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip
) -> None:
    clip = clip_of("ada", "walk")
    whole = MotionQuery(QuerySource(clip.id), include_self=True, limit=1)
    part = MotionQuery(QuerySource(clip.id, start=0.5, end=1.5), include_self=True, limit=100)
    assert find.find_motion(ready_library, whole).items[0].distance == pytest.approx(0, abs=1e-6)
    found = find.find_motion(ready_library, part).items
    assert next(h for h in found if h.clip.id == clip.id).distance > 1e-3
    demo = next(c for c in some_demo_clips if (c.person, c.task) == ("ada", "walk"))
    uploaded = MotionQuery(
        QuerySource(content=io.BytesIO(demo.content), start=0.5, end=1.5),
        limit=100,
        include_self=True,
    )
    theirs = find.find_motion(ready_library, uploaded).items
    assert [h.distance for h in theirs] == pytest.approx([h.distance for h in found], abs=1e-4)


@pytest.mark.parametrize(
    ("query", "location"),
    [
        ({"method": "nearest"}, "method"),
        ({"limit": 0}, "limit"),
        ({"limit": 1001}, "limit"),
        ({"scope": "frames"}, "scope"),
        ({"start": -1.0}, "start"),
        ({"start": 1.0, "end": 0.5}, "end"),
        ({"start": 1e6}, "start"),
        ({"end": 1e6}, "end"),
        ({"filter": {"colour": "red"}}, "filter.colour"),
        ({"tempo": "fast"}, "tempo"),
        ({"unit": "cm"}, "unit"),
        ({"content": io.BytesIO(b"x")}, "clip_id"),
    ],
)
def test_a_wrong_field_is_named(
    ready_library: Library, clip_of: FindClip, query: dict[str, Any], location: str
) -> None:
    with pytest.raises(BadField) as refused:
        find.find_motion(ready_library, motion_query(clip_id=clip_of("ada", "walk").id, **query))
    assert [place.location for place in refused.value.places] == [location]


def test_a_cursor_of_another_query_is_refused(ready_library: Library, clip_of: FindClip) -> None:
    walk, kick = clip_of("ada", "walk").id, clip_of("ada", "kick").id
    cursor = find.find_motion(ready_library, MotionQuery(QuerySource(walk), limit=2)).next
    with pytest.raises(PageNotFound):
        find.find_words(ready_library, WordQuery(["walk"], cursor=cursor))
    for other in (
        MotionQuery(QuerySource(kick), cursor=cursor),
        MotionQuery(QuerySource(walk), cursor=cursor, method="vector"),
        MotionQuery(QuerySource(walk), cursor=cursor, filter={"task": "walk"}),
        MotionQuery(QuerySource(walk, start=0.5), cursor=cursor),
        MotionQuery(QuerySource(walk), cursor=cursor, include_self=True),
        MotionQuery(QuerySource(walk), cursor=cursor, tempo="same"),
    ):
        with pytest.raises(PageNotFound):
            find.find_motion(ready_library, other)


def test_queries_that_cannot_be_used_are_refused_with_the_reason(ready_library: Library) -> None:
    with pytest.raises(ClipNotFound):
        find.find_motion(ready_library, MotionQuery(QuerySource("clip_none")))
    with pytest.raises(EmptyFile):
        find.find_motion(ready_library, MotionQuery(QuerySource(content=io.BytesIO(b""))))
    with pytest.raises(Unreadable) as refused:
        find.find_motion(
            ready_library, MotionQuery(QuerySource(content=io.BytesIO(b"HIERARCHY\nROOT x\n{\n")))
        )
    assert refused.value.places


def test_a_clip_that_is_not_ready_cannot_be_a_query(lib: Library) -> None:
    queued = clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), "a.bvh").clip
    with pytest.raises(ClipNotReady):
        find.find_motion(lib, MotionQuery(QuerySource(queued.id)))
    with pytest.raises(ModelNotFitted):
        find.find_words(lib, WordQuery(["walk"]))


@pytest.mark.parametrize("mode", WORD_MODES)
def test_words_find_the_clips_that_they_describe(ready_library: Library, mode: str) -> None:
    hits = find.find_words(ready_library, WordQuery(["Walk", "zebra"], mode=mode, limit=100))
    assert [hit.clip.task for hit in hits.items[:3]] == ["walk"] * 3
    assert hits.unknown_words == ("zebra",)
    assert len(hits.items) == 12
    for near, far in zip(hits.items, hits.items[1:], strict=False):
        assert (near.distance < far.distance) == (near.score > far.score)
    only = find.find_words(ready_library, WordQuery(["walk"], mode=mode, filter={"task": "kick"}))
    assert {hit.clip.task for hit in only.items} == {"kick"}


def test_unknown_words_find_nothing_and_are_reported(ready_library: Library) -> None:
    hits = find.find_words(ready_library, WordQuery(["zebra"]))
    assert (hits.items, hits.next, hits.unknown_words) == ((), None, ("zebra",))


@pytest.mark.parametrize(
    ("query", "location"),
    [
        (WordQuery([]), "words"),
        (WordQuery(["walk"], mode="best"), "mode"),
        (WordQuery(["walk"], limit=0), "limit"),
    ],
)
def test_a_wrong_field_of_a_word_search_is_named(
    ready_library: Library, query: WordQuery, location: str
) -> None:
    with pytest.raises(BadField) as refused:
        find.find_words(ready_library, query)
    assert [place.location for place in refused.value.places] == [location]


SCOPES = [
    {"method": "vector"},
    {"method": "dtw"},
    {"method": "metric-task"},
    {"scope": "windows", "start": 0.5, "end": 1.5},
    {"scope": "segments", "method": "vector"},
]


@pytest.mark.parametrize("asked", SCOPES, ids=str)
def test_a_search_by_a_stored_file_finds_what_a_search_by_its_clip_finds(
    ready_library: Library, clip_of: FindClip, asked: dict[str, Any]
) -> None:
    clip = clip_of("ada", "kick")
    content = ready_library.store.files.path(clip.sha256).read_bytes()
    part = {name: asked[name] for name in ("start", "end") if name in asked}
    options = {name: value for name, value in asked.items() if name not in part}

    def found(source: QuerySource, **more: Any) -> list[str]:
        query = MotionQuery(source, limit=1000, **options, **more)
        return [hit.clip.id for hit in find.find_motion(ready_library, query).items]

    by_clip = found(QuerySource(clip.id, **part))
    assert by_clip == found(QuerySource(content=io.BytesIO(content), **part))
    if asked.get("scope") is None:
        assert clip.id not in by_clip
    itself = found(QuerySource(content=io.BytesIO(content), **part), include_self=True)
    assert itself[0] == clip.id
    assert len(itself) > len(by_clip)
