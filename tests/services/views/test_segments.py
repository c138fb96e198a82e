"""The segments of a clip, from keypose to keypose, and the cycles that they form."""

from __future__ import annotations

import numpy as np
import pytest

from app.errors import ClipNotFound
from app.services.clips import catalogue as clips
from app.services.find.find import find_motion
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.views.keyposes import annotate_keyposes
from app.services.views.segments import Segments, list_segments, segment_arrays
from app.store.clips import arrays
from app.store.clips.record import ClipRecord
from tests.cyclic_dances import CyclicDance, cyclic_dance
from tests.libraries import FindClip, work
from tests.services.dances import upload_dance
from tests.store.stored_arrays import array_versions


@pytest.fixture
def danced(lib: Library) -> tuple[Library, ClipRecord, CyclicDance]:
    dance = cyclic_dance(400, poses=5, times=4)
    clip = upload_dance(lib, dance)
    work(lib.settings)
    return lib, clips.get_clip(lib, clip.id), dance


def _cycle_times(found: Segments) -> list[float]:
    return [cycle.end - cycle.start for cycle in found.cycles]


def test_segments_lie_between_keyposes_and_cycles_are_found(
    danced: tuple[Library, ClipRecord, CyclicDance],
) -> None:
    lib, clip, dance = danced
    found = list_segments(lib, clip.id)
    assert [one.index for one in found.segments] == list(range(len(found.segments)))
    assert all(a.end == b.start for a, b in zip(found.segments, found.segments[1:], strict=False))
    with lib.store.read() as tx:
        frames = arrays.get_one(tx, clip.id, "keypose_frames")
    assert [one.start for one in found.segments] == pytest.approx((frames[:-1] / 30).tolist())
    period = np.median([end - start for start, end in dance.cycles])
    assert len(found.cycles) >= 3
    assert np.median(_cycle_times(found)) == pytest.approx(period, rel=0.1)
    for cycle in found.cycles:
        own = [one for one in found.segments if one.cycle == cycle.index]
        assert [one.index for one in own] == list(range(cycle.first, cycle.first + cycle.count))
        assert (own[0].start, own[-1].end) == (cycle.start, cycle.end)


def test_a_clip_without_stored_segments_has_the_same(
    danced: tuple[Library, ClipRecord, CyclicDance],
) -> None:
    lib, clip, _ = danced
    before, stored = list_segments(lib, clip.id), segment_arrays(lib, clip)
    with lib.store.write() as tx:
        names = [n for n in array_versions(tx, clip.id) if not n.startswith("segment_")]
        kept = arrays.get_named(tx, clip.id, names)
        arrays.put_many(tx, clip.id, kept, version=1)
    assert list_segments(lib, clip.id) == before
    anew = segment_arrays(lib, clip)
    np.testing.assert_array_equal(anew["segment_vectors"], stored["segment_vectors"])


def test_a_clip_has_one_segment_less_than_keyposes(
    ready_library: Library, clip_of: FindClip
) -> None:
    for task in ("walk", "wave", "kick", "bow"):
        found = list_segments(ready_library, clip_of("ada", task).id)
        with ready_library.store.read() as tx:
            count = len(arrays.get_one(tx, clip_of("ada", task).id, "keypose_frames"))
        assert len(found.segments) == max(count - 1, 0)


def test_unknown_clips_are_not_found(lib: Library) -> None:
    with pytest.raises(ClipNotFound):
        list_segments(lib, "clip_none")


def test_segments_change_with_annotated_keyposes(
    danced: tuple[Library, ClipRecord, CyclicDance],
) -> None:
    lib, clip, _ = danced
    found = list_segments(lib, clip.id)
    annotate_keyposes(lib, clip.id, [0.5, 1.5, 4.0])
    named = list_segments(lib, clip.id)
    assert [(one.start, one.end) for one in named.segments] == [(0.5, 1.5), (1.5, 4.0)]
    asked = MotionQuery(QuerySource(clip.id), segment=0, scope="segments", include_self=True)
    hits = find_motion(lib, asked).items
    assert [(hit.start, hit.end) for hit in hits] == [(0.5, 1.5), (1.5, 4.0)]
    annotate_keyposes(lib, clip.id, [])
    assert list_segments(lib, clip.id) == found
