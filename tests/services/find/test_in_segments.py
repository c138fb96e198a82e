"""Finding steps among the segments of a library's clips."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from app.errors import BadField, ClipNotFound, PageNotFound
from app.services.clips import catalogue as clips
from app.services.find import find
from app.services.find.hits import Hits
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.views.segments import list_segments
from app.store.clips.record import ClipRecord
from tests.cyclic_dances import CyclicDance, cyclic_dance
from tests.libraries import settings_for, work
from tests.queries import motion_query
from tests.services.dances import dance_file, upload_dance

DANCERS = ("ada", "bruno", "chika")
CHOREOGRAPHIES = (500, 501)


def _dance(choreography: int, dancer: int) -> CyclicDance:
    return cyclic_dance(choreography, poses=6, times=3, dancer=dancer, tempo=80 + 10 * dancer)


@pytest.fixture(scope="module")
def danced(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Library]:
    """Two choreographies, each danced by three people."""
    lib = Library.open(settings_for(tmp_path_factory.mktemp("danced")))
    for choreography in CHOREOGRAPHIES:
        for number, dancer in enumerate(DANCERS):
            upload_dance(
                lib,
                _dance(choreography, number),
                f"{choreography}_{dancer}.npz",
                person=dancer,
                task=f"dance {choreography}",
            )
    work(lib.settings)
    yield lib
    lib.close()


@pytest.fixture
def clip(danced: Library) -> ClipRecord:
    return next(c for c in clips.list_clips(danced).items if c.name == "500_ada")


def _search(lib: Library, **asked: object) -> Hits:
    return find.find_motion(lib, motion_query(scope="segments", **asked))


def _middle(lib: Library, clip: ClipRecord) -> int:
    return list_segments(lib, clip.id).cycles[1].first + 1


def test_a_step_finds_the_same_step_in_other_cycles_and_by_other_dancers(
    danced: Library, clip: ClipRecord
) -> None:
    segment = _middle(danced, clip)
    hits = _search(danced, clip_id=clip.id, segment=segment, limit=6)
    assert hits.method == "vector"
    assert [hit.rank for hit in hits.items] == [1, 2, 3, 4, 5, 6]
    assert {hit.clip.task for hit in hits.items} == {"dance 500"}
    assert {hit.clip.person for hit in hits.items} == set(DANCERS)
    assert all(a.score > b.score for a, b in zip(hits.items, hits.items[1:], strict=False))
    for hit in hits.items:
        spans = [(one.start, one.end) for one in list_segments(danced, hit.clip.id).segments]
        assert any(np.allclose((hit.start, hit.end), span, atol=1e-4) for span in spans)


def test_the_queried_segment_is_a_hit_only_on_request(danced: Library, clip: ClipRecord) -> None:
    segment = _middle(danced, clip)
    own = list_segments(danced, clip.id).segments[segment]
    without = _search(danced, clip_id=clip.id, segment=segment, limit=1000)
    with_it = _search(danced, clip_id=clip.id, segment=segment, limit=1000, include_self=True)
    assert len(with_it.items) == len(without.items) + 1
    first = with_it.items[0]
    assert (first.clip.id, first.distance, first.score) == (clip.id, 0.0, 1.0)
    assert first.start == pytest.approx(own.start)
    neighbours = [hit for hit in without.items if hit.clip.id == clip.id]
    assert len(neighbours) == len(list_segments(danced, clip.id).segments) - 1


def test_a_part_of_a_clip_finds_as_its_segment_does(danced: Library, clip: ClipRecord) -> None:
    own = list_segments(danced, clip.id).segments[_middle(danced, clip)]
    by_index = _search(danced, clip_id=clip.id, segment=own.index, limit=3)
    by_time = _search(danced, clip_id=clip.id, start=own.start, end=own.end, limit=3)
    assert {hit.clip.task for hit in by_time.items} == {"dance 500"}
    assert by_time.items[0].distance == pytest.approx(by_index.items[0].distance, abs=0.15)


def test_an_upload_is_taken_as_one_segment(danced: Library, clip: ClipRecord) -> None:
    own = list_segments(danced, clip.id).segments[_middle(danced, clip)]
    file = io.BytesIO(dance_file(_dance(500, 0)))
    part = {"content": file, "start": own.start, "end": own.end}
    hits = _search(danced, **part, limit=1, include_self=True)
    assert hits.items[0].clip.id == clip.id
    assert hits.items[0].start == pytest.approx(own.start, abs=0.05)


def test_filters_apply_to_segments(danced: Library, clip: ClipRecord) -> None:
    segment = _middle(danced, clip)
    hits = _search(danced, clip_id=clip.id, segment=segment, filter={"person": ["bruno"]})
    assert {hit.clip.person for hit in hits.items} == {"bruno"}
    none = _search(danced, clip_id=clip.id, segment=segment, filter={"task": ["sleep"]})
    assert none.items == ()
    assert none.next is None


def test_pages_follow_each_other(danced: Library, clip: ClipRecord) -> None:
    asked = {"clip_id": clip.id, "segment": _middle(danced, clip)}
    whole = _search(danced, **asked, limit=1000)
    seen, cursor = [], None
    while True:
        page = _search(danced, **asked, limit=25, cursor=cursor)
        seen += page.items
        if (cursor := page.next) is None:
            break
    assert [(h.rank, h.clip.id, h.start) for h in seen] == [
        (h.rank, h.clip.id, h.start) for h in whole.items
    ]
    first = _search(danced, **asked, limit=5)
    with pytest.raises(PageNotFound):
        _search(danced, clip_id=clip.id, segment=0, limit=5, cursor=first.next)


def test_both_methods_give_the_same_ranking(danced: Library, clip: ClipRecord) -> None:
    asked = {"clip_id": clip.id, "segment": 2}
    fused, vector = (_search(danced, **asked, method=m).items for m in ("fused", "vector"))
    assert fused == vector


@pytest.mark.parametrize(
    ("asked", "field"),
    [
        ({"segment": 999}, "segment"),
        ({"segment": -1}, "segment"),
        ({"segment": 1, "start": 0.5}, "start"),
        ({"segment": 1, "end": 0.5}, "end"),
        ({"segment": 1, "method": "dtw"}, "method"),
    ],
)
def test_fields_that_exclude_each_other_are_refused_by_name(
    danced: Library, clip: ClipRecord, asked: dict[str, object], field: str
) -> None:
    with pytest.raises(BadField) as caught:
        _search(danced, clip_id=clip.id, **asked)
    assert [place.location for place in caught.value.places] == [field]


def test_segments_are_of_stored_clips_and_of_their_scope(danced: Library, clip: ClipRecord) -> None:
    with pytest.raises(BadField, match="stored clip"):
        _search(danced, content=io.BytesIO(b"x"), segment=1)
    with pytest.raises(BadField, match="scope segments"):
        find.find_motion(danced, MotionQuery(QuerySource(clip.id), segment=1))
    with pytest.raises(ClipNotFound):
        _search(danced, clip_id="clip_none", segment=1)


def test_new_clips_are_found_and_deleted_ones_are_not(lib: Library, tmp_path: Path) -> None:
    first = upload_dance(lib, _dance(510, 0), "one.npz")
    work(lib.settings)
    assert all(h.clip.id == first.id for h in _search(lib, clip_id=first.id, segment=3).items)
    second = upload_dance(lib, _dance(510, 1), "two.npz")
    work(lib.settings)
    both = _search(lib, clip_id=first.id, segment=3, limit=100)
    assert {hit.clip.id for hit in both.items} == {first.id, second.id}
    clips.delete_clip(lib, second.id)
    left = _search(lib, clip_id=first.id, segment=3, limit=100)
    assert {hit.clip.id for hit in left.items} == {first.id}
