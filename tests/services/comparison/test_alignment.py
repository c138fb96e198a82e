"""Two stored clips are compared as a search by `dtw` compares them."""

from __future__ import annotations

import numpy as np
import pytest

from app.errors import BadField, ClipNotFound, ClipNotReady
from app.motion.frame.body_frame import body_length
from app.search.example.methods import Method
from app.services.comparison import alignment
from app.services.comparison.alignment import Part, align_clips
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from tests.cyclic_dances import cyclic_dance
from tests.libraries import FindClip
from tests.services.dances import upload_dance


def test_the_distance_is_what_the_search_shows(ready_library: Library, clip_of: FindClip) -> None:
    walk, wave = clip_of("ada", "walk"), clip_of("bruno", "wave")
    found = align_clips(ready_library, Part(walk.id), Part(wave.id))
    asked = MotionQuery(QuerySource(walk.id), method=Method.DTW, limit=20)
    shown = {hit.clip.id: hit.distance for hit in find_motion(ready_library, asked).items}
    assert found.distance == pytest.approx(shown[wave.id], rel=1e-4)


def test_times_go_from_start_to_end_of_both(ready_library: Library, clip_of: FindClip) -> None:
    walk, kick = clip_of("ada", "walk"), clip_of("bruno", "kick")
    found = align_clips(ready_library, Part(walk.id), Part(kick.id))
    np.testing.assert_allclose(found.times[0], [0, 0], atol=0.5)
    assert walk.duration is not None
    assert kick.duration is not None
    np.testing.assert_allclose(found.times[-1], [walk.duration, kick.duration], atol=0.5)
    assert (np.diff(found.times, axis=0) >= 0).all()
    lengths = [body_length(load_motion(ready_library, clip)) for clip in (walk, kick)]
    assert found.body_lengths == pytest.approx(lengths)


def test_both_clips_have_equal_parts_in_the_result(
    ready_library: Library, clip_of: FindClip
) -> None:
    walk, kick = clip_of("ada", "walk").id, clip_of("bruno", "kick").id
    there = align_clips(ready_library, Part(walk, 0.5), Part(kick, end=2.0))
    back = align_clips(ready_library, Part(kick, end=2.0), Part(walk, 0.5))
    assert there.distance == pytest.approx(back.distance)
    np.testing.assert_allclose(there.times, back.times[:, ::-1])
    np.testing.assert_allclose(there.differences, back.differences)
    assert there.body_lengths == back.body_lengths[::-1]


def test_a_part_is_found_in_its_own_clip(ready_library: Library, clip_of: FindClip) -> None:
    walk = clip_of("ada", "walk").id
    found = align_clips(ready_library, Part(walk, 0.5, 2.0), Part(walk, 0.5, 2.0))
    assert found.times[0] == pytest.approx([0.5, 0.5], abs=0.02)
    assert found.times[-1] == pytest.approx([2.0, 2.0], abs=0.15)
    assert found.distance == 0
    assert found.differences.max() == 0


@pytest.mark.parametrize(
    ("one", "other", "field"),
    [
        (Part("a", start=900.0), Part("b"), "start"),
        (Part("a"), Part("b", start=900.0), "other_start"),
        (Part("a", end=900.0), Part("b"), "end"),
        (Part("a"), Part("b", start=2.0, end=1.0), "other_end"),
    ],
)
def test_parts_outside_of_a_clip_are_refused(
    ready_library: Library, clip_of: FindClip, one: Part, other: Part, field: str
) -> None:
    ids = {"a": clip_of("ada", "walk").id, "b": clip_of("ada", "wave").id}
    one, other = (Part(ids[part.clip_id], part.start, part.end) for part in (one, other))
    with pytest.raises(BadField) as failure:
        align_clips(ready_library, one, other)
    assert [place.location for place in failure.value.places] == [field]
    assert failure.value.detail.startswith(f"{field}: ")


def test_too_long_parts_are_refused(
    ready_library: Library, clip_of: FindClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(alignment, "MAX_SECONDS", 2.0)
    walk, wave = clip_of("ada", "walk").id, clip_of("ada", "wave").id
    for one, other, field in (
        (Part(walk), Part(wave, 0, 1), "clip_id"),
        (Part(walk, 0, 1), Part(wave), "other"),
        (Part(walk, 0, 2.5), Part(wave, 0, 1), "end"),
    ):
        with pytest.raises(BadField, match="at most 2 s") as failure:
            align_clips(ready_library, one, other)
        assert failure.value.places[0].location == field
    assert len(align_clips(ready_library, Part(walk, 0, 1), Part(wave, 0.5, 1.5)).times)


def test_unknown_and_waiting_clips_are_named(
    ready_library: Library, clip_of: FindClip, lib: Library
) -> None:
    walk = clip_of("ada", "walk").id
    with pytest.raises(ClipNotFound) as failure:
        align_clips(ready_library, Part(walk), Part("clip_none"))
    assert failure.value.places[0].location == "other"
    waiting = upload_dance(lib, cyclic_dance(1)).id
    with pytest.raises(ClipNotReady):
        align_clips(lib, Part(waiting), Part(waiting))
