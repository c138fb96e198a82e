"""Searches by several parts over a library that a worker has analyzed and fitted."""

from __future__ import annotations

import io
import math
from dataclasses import replace
from typing import Any

import pytest

from app.demo import DemoClip
from app.errors import BadField, ClipNotFound, PageNotFound
from app.search.example.methods import Method
from app.services.find import find
from app.services.find.by_parts import MAX_EXAMPLES, find_by_parts
from app.services.find.hits import Hits
from app.services.find.queries import (
    WORD_MODES,
    ComposedQuery,
    Example,
    MotionQuery,
    WordQuery,
)
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store.clips.record import ClipRecord
from tests.libraries import FindClip, settings_for, upload, work

METHODS = list(Method)
OTHER_THAN_TASKS = {Method.MSV_DTW, Method.MSV_XCORR, Method.METRIC_PERSON}
"""Methods that do not put the same task first, also with one example."""
COUNT = 12


def _like(*found: ClipRecord, against: ClipRecord | None = None) -> list[Example]:
    examples = [
        Example(f"examples.{index}", QuerySource(clip.id)) for index, clip in enumerate(found)
    ]
    if against is not None:
        part = f"examples.{len(examples)}"
        examples.append(Example(part, QuerySource(against.id), is_against=True))
    return examples


def _order(hits: Hits) -> list[tuple[int, str, float, float]]:
    return [(hit.rank, hit.clip.id, hit.distance, hit.score) for hit in hits.items]


def _labels(hits: Hits) -> list[tuple[str | None, str | None]]:
    return [(hit.clip.person, hit.clip.task) for hit in hits.items]


@pytest.mark.parametrize("method", METHODS)
def test_one_example_is_answered_as_the_search_by_example(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    clip = clip_of("ada", "wave")
    alone = find_by_parts(ready_library, ComposedQuery(_like(clip), method=method, limit=100))
    by_example = MotionQuery(QuerySource(clip.id), method=method, limit=100)
    assert _order(alone) == _order(find.find_motion(ready_library, by_example))
    assert [[part.score for part in hit.parts] for hit in alone.items] == [
        [hit.score] for hit in alone.items
    ]


@pytest.mark.parametrize("mode", WORD_MODES)
@pytest.mark.parametrize("words", [["wave"], ["wave", "-ada"], ["walk", "old"]])
def test_words_alone_are_answered_as_the_search_by_words(
    ready_library: Library, words: list[str], mode: str
) -> None:
    alone = find_by_parts(ready_library, ComposedQuery(words=words, mode=mode, limit=100))
    by_words = find.find_words(ready_library, WordQuery(words, mode=mode, limit=100))
    assert _order(alone) == _order(by_words)
    assert (alone.method, alone.unknown_words) == (mode, by_words.unknown_words)
    assert (alone.expanded or {}) == (by_words.expanded or {})


@pytest.mark.parametrize("method", [m for m in METHODS if m not in OTHER_THAN_TASKS])
def test_two_takes_of_a_task_find_the_third(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    for task in ("walk", "bow"):
        examples = _like(clip_of("ada", task), clip_of("bruno", task))
        found = find_by_parts(ready_library, ComposedQuery(examples, method=method, limit=1))
        assert _labels(found) == [("chika", task)]


@pytest.mark.parametrize("method", METHODS)
def test_every_other_clip_is_a_hit_with_the_score_of_each_part(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    examples = _like(clip_of("ada", "walk"), against=clip_of("ada", "kick"))
    query = ComposedQuery(examples, ["wave", "-bruno"], method=method, limit=100)
    found = find_by_parts(ready_library, query)
    assert found.method == method.value
    assert all(0 <= hit.score <= 1 for hit in found.items)
    distances = [hit.distance for hit in found.items]
    assert distances == sorted(distances)
    for hit in found.items:
        assert [(part.part, part.is_against) for part in hit.parts][:3] == [
            ("examples.0", False),
            ("examples.1", True),
            ("words.0", False),
        ]
        like, unlike, word = (part.score for part in hit.parts[:3])
        expected = (like * (1 - unlike) * word) ** (1 / 3)
        assert hit.score == pytest.approx(expected, rel=1e-6)
        assert hit.score == pytest.approx(math.exp(-hit.distance))


def test_an_example_and_a_word_find_what_is_both(ready_library: Library, clip_of: FindClip) -> None:
    query = ComposedQuery(_like(clip_of("ada", "wave")), ["wave"], limit=2)
    assert {task for _, task in _labels(find_by_parts(ready_library, query))} == {"wave"}


def test_a_word_with_a_minus_leaves_clips_out_and_an_example_against_pushes_them_down(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk = _like(clip_of("ada", "walk"))
    without = find_by_parts(ready_library, ComposedQuery(walk, ["-kick"], limit=100))
    assert "kick" not in {task for _, task in _labels(without)}
    assert len(without.items) == COUNT - 4
    against = _like(clip_of("ada", "walk"), against=clip_of("bruno", "kick"))
    pushed, plain = (
        _labels(find_by_parts(ready_library, ComposedQuery(some, method=Method.VECTOR, limit=100)))
        for some in (against, walk)
    )
    assert len(pushed) == COUNT - 2
    assert pushed.index(("ada", "kick")) > plain.index(("ada", "kick"))
    assert pushed[0] == plain[0]


def test_only_the_proportion_of_weights_counts_and_a_heavy_example_leads(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk, bow = _like(clip_of("ada", "walk"), clip_of("ada", "bow"))

    def found(one: float, other: float) -> Hits:
        examples = [replace(walk, weight=one), replace(bow, weight=other)]
        return find_by_parts(ready_library, ComposedQuery(examples, limit=2))

    assert {task for _, task in _labels(found(100, 1))} == {"walk"}
    assert {task for _, task in _labels(found(1, 100))} == {"bow"}
    assert [d for *_, d in _order(found(2, 4))] == pytest.approx(
        [d for *_, d in _order(found(1, 2))]
    )


@pytest.mark.parametrize("method", METHODS)
def test_pages_together_are_the_whole_ranking(
    ready_library: Library, clip_of: FindClip, method: Method
) -> None:
    examples = _like(clip_of("ada", "walk"), clip_of("bruno", "wave"))
    query = ComposedQuery(examples, ["-bow"], method=method, limit=3)
    pages = [find_by_parts(ready_library, query)]
    while (cursor := pages[-1].next) is not None:
        pages.append(find_by_parts(ready_library, replace(query, cursor=cursor)))
    whole = find_by_parts(ready_library, replace(query, limit=100))
    assert [one for page in pages for one in _order(page)] == _order(whole)
    assert len(whole.items) > 6


def test_clips_that_come_between_two_pages_shift_no_other_hit(
    tmp_path: Any, some_demo_clips: list[DemoClip]
) -> None:
    lib = Library.open(settings_for(tmp_path))
    first = [upload(lib, clip).clip.id for clip in some_demo_clips[:8]]
    work(lib.settings)
    examples = [
        Example(f"examples.{index}", QuerySource(clip_id))
        for index, clip_id in enumerate(first[:2])
    ]
    query = ComposedQuery(examples, method=Method.VECTOR, limit=2)
    whole = _order(find_by_parts(lib, replace(query, limit=100)))
    page = find_by_parts(lib, query)
    new = {upload(lib, clip).clip.id for clip in some_demo_clips[8:]}
    work(lib.settings)
    rest = find_by_parts(lib, replace(query, cursor=page.next, limit=100))
    lib.close()
    old = [(clip_id, distance) for _, clip_id, distance, _ in _order(rest) if clip_id not in new]
    assert old == [(clip_id, distance) for _, clip_id, distance, _ in whole[2:]]


def test_an_uploaded_file_is_an_example(
    ready_library: Library, some_demo_clips: list[DemoClip], clip_of: FindClip
) -> None:
    demo = next(c for c in some_demo_clips if (c.person, c.task) == ("ada", "bow"))
    file = Example("file", QuerySource(content=io.BytesIO(demo.content)))
    examples = [*_like(clip_of("bruno", "bow")), file]
    found = find_by_parts(ready_library, ComposedQuery(examples, limit=100))
    assert _labels(found)[0] == ("chika", "bow")
    assert clip_of("ada", "bow").id not in {hit.clip.id for hit in found.items}
    assert [part.part for part in found.items[0].parts] == ["examples.0", "file"]


def test_examples_are_hits_only_on_request(ready_library: Library, clip_of: FindClip) -> None:
    ours = clip_of("ada", "walk"), clip_of("bruno", "walk")
    query = ComposedQuery(_like(*ours), limit=100)
    assert not {c.id for c in ours} & {h.clip.id for h in find_by_parts(ready_library, query).items}
    with_them = find_by_parts(ready_library, replace(query, include_self=True))
    assert {hit.clip.id for hit in with_them.items[:2]} == {clip.id for clip in ours}


def test_a_blank_word_shifts_no_other(ready_library: Library, clip_of: FindClip) -> None:
    query = ComposedQuery(_like(clip_of("ada", "walk")), [" ", "wave"], limit=1)
    (hit,) = find_by_parts(ready_library, query).items
    assert [part.part for part in hit.parts] == ["examples.0", "words.1"]


def test_a_word_that_the_library_does_not_know_is_reported(
    ready_library: Library, clip_of: FindClip
) -> None:
    query = ComposedQuery(_like(clip_of("ada", "walk")), ["qwertz"], limit=100)
    found = find_by_parts(ready_library, query)
    assert found.unknown_words == ("qwertz",)
    assert len(found.items) == COUNT - 1
    assert {len(hit.parts) for hit in found.items} == {1}
    against = _like(against=clip_of("ada", "walk"))
    nothing = find_by_parts(ready_library, ComposedQuery(against, ["qwertz"], limit=100))
    assert nothing.items == ()


@pytest.mark.parametrize(
    ("changes", "location"),
    [
        ({"examples": []}, "examples"),
        ({"examples": [], "words": ["-wave"]}, "words"),
        ({"method": "nearest"}, "method"),
        ({"mode": "best"}, "mode"),
        ({"limit": 0}, "limit"),
        ({"words": [" "]}, "words"),
    ],
)
def test_what_is_wrong_is_named(
    ready_library: Library, clip_of: FindClip, changes: dict[str, Any], location: str
) -> None:
    query = ComposedQuery(_like(clip_of("ada", "walk"), clip_of("ada", "kick")))
    with pytest.raises(BadField) as refused:
        find_by_parts(ready_library, replace(query, **changes))
    assert location in {place.location for place in refused.value.places}


def test_a_cursor_that_is_none_is_refused(ready_library: Library, clip_of: FindClip) -> None:
    with pytest.raises(PageNotFound):
        find_by_parts(
            ready_library, replace(ComposedQuery(_like(clip_of("ada", "walk"))), cursor="x")
        )


def test_the_wrong_example_is_named(ready_library: Library, clip_of: FindClip) -> None:
    good = _like(clip_of("ada", "walk"))
    wrong: list[tuple[Example, str]] = [
        (Example("examples.1", QuerySource(good[0].source.clip_id, start=1e5)), ".start"),
        (replace(good[0], part="examples.1", weight=0.0), ".weight"),
        (replace(good[0], part="examples.1", weight=math.nan), ".weight"),
    ]
    for example, field in wrong:
        with pytest.raises(BadField) as refused:
            find_by_parts(ready_library, ComposedQuery([*good, example]))
        assert refused.value.places[0].location == f"examples.1{field}"
    unknown = Example("examples.1", QuerySource("nope"))
    with pytest.raises(ClipNotFound):
        find_by_parts(ready_library, ComposedQuery([*good, unknown]))
    with pytest.raises(BadField):
        find_by_parts(ready_library, ComposedQuery(good * (MAX_EXAMPLES + 1)))
    only_against = ComposedQuery([replace(good[0], is_against=True)])
    with pytest.raises(BadField):
        find_by_parts(ready_library, only_against)
