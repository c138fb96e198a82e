"""Searches inside long clips, for pieces that were warped, turned, moved and inserted there."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from app.demo import DemoClip
from app.errors import BadField, PageNotFound
from app.numerics.arrays import FloatArray
from app.search.windows.overlap_merging import MAX_OVERLAP
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.hits import Hit, Hits
from app.services.find.in_windows import MAX_SECONDS
from app.services.library.library import Library
from tests.bodies import turned_about_y
from tests.libraries import settings_for, work
from tests.queries import motion_query
from tests.streams import at_rate, body_of, joined, npz_of, of_size, warped

METHODS = ["fused", "vector", "dtw"]
WARPS = ((0.9, 0.1), (1.0, -0.1), (1.1, 0.0))
"""Factor of the length, and by how much the speed sways, of the three times a piece is hidden."""

PIECES = {
    "short": ("bruno", "kick", 0.4, 1.2),
    "kick": ("ada", "kick", 0.3, 1.9),
    "bow": ("chika", "bow", 0.5, 3.5),
}
"""Whose clip it is cut from, and from when to when in seconds."""


@dataclass(frozen=True)
class Hidden:
    """Long clips by name, where in them each piece stands, and the pieces themselves."""

    lib: Library
    ids: dict[str, str]
    places: dict[str, list[tuple[str, float, float]]]
    pieces: dict[str, FloatArray]


def put(lib: Library, name: str, body: FloatArray, rate: float, **labels: Any) -> str:
    content = io.BytesIO(npz_of(body, rate))
    return clips.create_clip(lib, content, f"{name}.npz", labels).clip.id


@pytest.fixture(scope="session")
def hidden(
    tmp_path_factory: pytest.TempPathFactory, some_demo_clips: list[DemoClip]
) -> Iterator[Hidden]:
    """Three long clips at 30, 50 and 60 Hz; each piece is once in each. Not to be changed."""
    bodies = {(c.person, c.task): body_of(c.content) for c in some_demo_clips}
    pieces = {
        name: bodies[person, task][round(first * 30) : round(last * 30)]
        for name, (person, task, first, last) in PIECES.items()
    }
    filling = [body for (_, task), body in bodies.items() if task in ("walk", "wave")]
    long = joined(filling[:4], 30.0).body[60:360]
    pieces["ten seconds"] = long
    lib = Library.open(settings_for(tmp_path_factory.mktemp("hidden"), refit_growth=1e9))
    ids, places = {}, {name: [] for name in pieces}
    for number, (rate, (factor, bend)) in enumerate(zip((30.0, 50.0, 60.0), WARPS, strict=True)):
        parts = filling[4:] if number else filling[2:]
        for piece in pieces.values():
            turned = turned_about_y(warped(piece, factor, bend), number + 0.5)
            parts = [*parts[:-1], turned + np.array([number, 0.0, 2.0]), parts[-1]]
        stream = joined(parts, 30.0)
        name = f"stream {number}"
        body = of_size(stream.body, 1.0 + number / 10)
        ids[name] = put(lib, name, at_rate(body, 30.0, rate), rate, task=f"task {number}")
        for spans, piece_name in zip(stream.spans[-1 - len(pieces) : -1], pieces, strict=True):
            places[piece_name].append((ids[name], *spans))
    ids["long"] = put(lib, "long", joined(filling[:4], 30.0).body, 30.0, task="long")
    work(lib.settings)
    yield Hidden(lib, ids, places, pieces)
    lib.close()


def search(lib: Library, **query: Any) -> Hits:
    return find.find_motion(lib, motion_query(scope="windows", **query))


def sought(hidden: Hidden, piece: str, **query: Any) -> Hits:
    content = io.BytesIO(npz_of(hidden.pieces[piece], 30.0))
    return search(hidden.lib, content=content, filter={"task": TASKS}, **query)


TASKS = [f"task {number}" for number in range(3)]


@pytest.mark.parametrize("piece", [*PIECES, "ten seconds"])
@pytest.mark.parametrize(("method", "tolerance"), [("fused", 0.15), ("dtw", 0.15), ("vector", 0.8)])
def test_a_hidden_piece_is_found_first_with_its_start_and_end(
    hidden: Hidden, piece: str, method: str, tolerance: float
) -> None:
    hits = sought(hidden, piece, method=method, limit=3).items
    places = {clip_id: (start, end) for clip_id, start, end in hidden.places[piece]}
    if method != "vector":
        assert {hit.clip.id for hit in hits} == set(places)
    for hit in hits[:1] if method == "vector" else hits:
        start, end = places[hit.clip.id]
        assert (hit.start, hit.end) == pytest.approx((start, end), abs=tolerance)


def test_a_part_of_a_clip_is_a_query_and_only_that_part_is_left_out(
    hidden: Hidden,
) -> None:
    clip_id, start, end = hidden.places["kick"][1]
    asked = {"clip_id": clip_id, "start": start, "end": end}
    for method in METHODS:
        hits = search(hidden.lib, method=method, limit=1000, **asked).items
        own = [hit for hit in hits if hit.clip.id == clip_id]
        assert own
        assert not [hit for hit in own if hit.start < end - 0.1 and hit.end > start + 0.1]
    first = search(hidden.lib, include_self=True, limit=1, **asked).items[0]
    assert first.clip.id == clip_id
    assert (first.start, first.end) == pytest.approx((start, end), abs=0.1)
    assert first.score > search(hidden.lib, limit=1, **asked).items[0].score


def test_a_whole_clip_is_a_query_too(hidden: Hidden) -> None:
    asked = {"clip_id": hidden.ids["long"], "limit": 1}
    itself = search(hidden.lib, include_self=True, **asked).items[0]
    assert (itself.clip.id, itself.start) == (hidden.ids["long"], 0.0)
    assert itself.end == itself.clip.duration
    assert itself.distance == pytest.approx(0.0, abs=1e-6)
    assert search(hidden.lib, **asked).items[0].clip.id != hidden.ids["long"]


@pytest.mark.parametrize("method", METHODS)
def test_hits_do_not_overlap_and_scores_fall_with_distance(hidden: Hidden, method: str) -> None:
    hits = sought(hidden, "kick", method=method, limit=1000)
    assert hits.method == method
    assert hits.next is None
    assert [hit.rank for hit in hits.items] == list(range(1, len(hits.items) + 1))
    for near, far in pairwise(hits.items):
        assert near.distance <= far.distance
        assert (near.distance < far.distance) == (near.score > far.score)
    by_clip: dict[str, list[Hit]] = {}
    for hit in hits.items:
        assert 0 <= hit.score <= 1
        assert 0 <= hit.start < hit.end <= (hit.clip.duration or 0)
        by_clip.setdefault(hit.clip.id, []).append(hit)
    for of_one in by_clip.values():
        of_one.sort(key=lambda hit: hit.start)
        for one, other in pairwise(of_one):
            shorter = min(one.end - one.start, other.end - other.start)
            assert one.end - other.start <= MAX_OVERLAP * shorter + 1e-9


@pytest.mark.parametrize("method", METHODS)
def test_all_pages_together_are_the_whole_ranking(hidden: Hidden, method: str) -> None:
    whole = sought(hidden, "short", method=method, limit=1000).items
    pages = [sought(hidden, "short", method=method, limit=17)]
    while pages[-1].next is not None:
        cursor = pages[-1].next
        pages.append(sought(hidden, "short", method=method, limit=17, cursor=cursor))
    assert len(pages) >= 3
    paged = [hit for page in pages for hit in page.items]
    assert [(h.rank, h.clip.id, h.start, h.distance) for h in paged] == [
        (h.rank, h.clip.id, h.start, h.distance) for h in whole
    ]


@pytest.mark.parametrize("method", METHODS)
def test_a_filter_is_applied_before_the_ranking(hidden: Hidden, method: str) -> None:
    content = io.BytesIO(npz_of(hidden.pieces["bow"], 30.0))
    asked = {"content": content, "method": method, "limit": 50}
    hits = search(hidden.lib, filter={"task": ["task 1"]}, **asked).items
    assert {hit.clip.id for hit in hits} == {hidden.ids["stream 1"]}


@pytest.mark.parametrize(
    ("query", "location"),
    [
        ({"method": "msv-dtw"}, "method"),
        ({"start": 1e4}, "start"),
        ({"limit": 0}, "limit"),
        ({"scope": "frames"}, "scope"),
    ],
)
def test_a_wrong_field_is_named(hidden: Hidden, query: dict[str, Any], location: str) -> None:
    asked = {"clip_id": hidden.ids["long"], "scope": "windows"} | query
    with pytest.raises(BadField) as refused:
        find.find_motion(hidden.lib, motion_query(**asked))
    assert [place.location for place in refused.value.places] == [location]


def test_a_too_long_query_is_refused_with_the_limit(hidden: Hidden) -> None:
    body = np.tile(hidden.pieces["ten seconds"], (13, 1, 1))
    with pytest.raises(BadField, match=r"120 s.*130\.0 s") as refused:
        search(hidden.lib, content=io.BytesIO(npz_of(body, 30.0)))
    assert [place.location for place in refused.value.places] == ["end"]
    part = search(hidden.lib, content=io.BytesIO(npz_of(body, 30.0)), end=MAX_SECONDS)
    assert part.items


def test_a_cursor_of_another_query_is_refused(hidden: Hidden) -> None:
    clip_id = hidden.ids["long"]
    asked = {"clip_id": clip_id, "start": 2.0, "end": 4.0, "limit": 1}
    cursor = search(hidden.lib, **asked).next
    for other in ({"end": 5.0}, {"method": "dtw"}, {"filter": {"task": "task 1"}},
                  {"include_self": True}, {"scope": "clips"}):  # fmt: skip
        query = {"scope": "windows", **asked, **other, "cursor": cursor}
        with pytest.raises(PageNotFound):
            find.find_motion(hidden.lib, motion_query(**query))


def test_searches_follow_new_and_deleted_clips_while_pages_stay_consistent(
    lib: Library, hidden: Hidden
) -> None:
    piece = hidden.pieces["kick"]
    body = joined([hidden.pieces["bow"], piece, hidden.pieces["bow"]], 30.0)
    put(lib, "first", body.body, 30.0)
    work(lib.settings)
    asked = {"limit": 1}
    upload = npz_of(piece, 30.0)
    page = search(lib, content=io.BytesIO(upload), **asked)
    assert page.items[0].start == pytest.approx(body.spans[1][0], abs=0.15)
    late = put(lib, "late", warped(piece, 1.05), 30.0)
    work(lib.settings)
    assert search(lib, content=io.BytesIO(upload), limit=2).items[1].clip.id == late
    following = search(lib, content=io.BytesIO(upload), cursor=page.next, **asked)
    assert (following.items[0].rank, following.items[0].clip.id) == (2, late)
    clips.delete_clip(lib, late)
    left = search(lib, content=io.BytesIO(upload), limit=1000).items
    assert late not in {hit.clip.id for hit in left}
