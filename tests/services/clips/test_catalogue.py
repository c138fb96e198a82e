"""Clips: added once, analyzed again on request, changed, removed."""

from __future__ import annotations

import io
from typing import Any

import pytest

from app.demo import DemoClip
from app.errors import BadField, ClipNotFound, EmptyFile, NotFound, TooLarge, UnknownFormat
from app.search.example.methods import Method
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.find import find
from app.services.find.queries import MotionQuery
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.store.clips.record import ClipState, Reanalysis
from app.store.files import id_file
from app.store.jobs.record import JobState
from tests.libraries import settings_for, upload, work

NOT_HUMAN = (
    b"HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\nCHANNELS 3 Xrotation Yrotation Zrotation\n"
    b"End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 2\nFrame Time: .03\n0 0 0\n1 1 1\n"
)


def test_the_same_bytes_again_give_the_existing_clip(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    first = upload(lib, some_demo_clips[0], words=("Walk", "left-leg", "walk"))
    again = upload(lib, some_demo_clips[0], person="someone else")
    assert (first.is_new, first.clip.state, first.clip.words) == (
        True,
        ClipState.QUEUED,
        ("walk", "left_leg"),
    )
    assert (again.is_new, again.job, again.clip) == (False, None, first.clip)
    stored = clips.open_file(lib, first.clip.id)
    assert stored.path.read_bytes() == some_demo_clips[0].content
    assert stored.size == len(some_demo_clips[0].content)


def test_bad_content_fails_at_once_for_its_own_reason_and_can_be_sent_again(lib: Library) -> None:
    created = clips.create_clip(lib, io.BytesIO(NOT_HUMAN), "stick.bvh")
    work(lib.settings)
    failed = clips.get_clip(lib, created.clip.id)
    assert failed.state is ClipState.FAILED
    assert failed.error is not None
    assert failed.error["code"] == "skeleton_not_human"
    assert created.job is not None
    job = jobs.get_job(lib, created.job.id)
    assert (job.state, job.error) == (JobState.FAILED, failed.error)
    again = clips.create_clip(lib, io.BytesIO(NOT_HUMAN), "stick.bvh", {"person": "ada"})
    assert (again.is_new, again.clip.id, again.clip.state) == (True, failed.id, ClipState.QUEUED)
    assert again.clip.person == "ada"


@pytest.mark.parametrize(
    ("content", "failure"),
    [(b"", EmptyFile), (b"hello there", UnknownFormat), (b"HIERARCHY" + bytes(99), TooLarge)],
)
def test_content_that_no_reader_knows_is_refused_and_not_stored(
    tmp_path: Any, content: bytes, failure: type[Exception]
) -> None:
    lib = Library.open(settings_for(tmp_path, max_upload_bytes=50))
    with pytest.raises(failure):
        clips.create_clip(lib, io.BytesIO(content), "a.bvh")
    assert clips.list_clips(lib).items == ()
    kept = [path.name for path in lib.settings.files_dir.rglob("*") if path.is_file()]
    assert kept == [id_file.NAME]
    lib.close()


@pytest.mark.parametrize(
    ("said", "location"),
    [
        ({"name": "a\x00b"}, "name"),
        ({"person": "x" * 301}, "person"),
        ({"words": tuple(f"w{i}" for i in range(101))}, "words"),
        ({"frame_rate": 0}, "frame_rate"),
        ({"frame_rate": "fast"}, "frame_rate"),
        ({"unit": "ell"}, "unit"),
        ({"unit": -1}, "unit"),
        ({"up_axis": "w"}, "up_axis"),
        ({"roles": {"hips": []}}, "roles.hips"),
        ({"roles": {"hips": ["a", "b", "c"]}}, "roles.hips"),
        ({"roles": {"hips": ["a", 3]}}, "roles.hips"),
        ({"roles": {"tail": "x"}}, "roles.tail"),
        ({"roles": {"hips": 3}}, "roles.hips"),
    ],
)
def test_a_wrong_field_is_named(lib: Library, said: dict[str, Any], location: str) -> None:
    with pytest.raises(BadField) as refused:
        clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), "a.bvh", said)
    assert [place.location for place in refused.value.places] == [location]


def test_a_file_name_has_no_folder(lib: Library) -> None:
    given = "..\\..//etc/pass\nwd.bvh"
    clip = clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), given).clip
    assert (clip.file_name, clip.name) == ("passwd.bvh", "passwd")


@pytest.mark.parametrize("name", ["", ".", "..", "../..", "\n"])
def test_a_file_without_a_name_is_called_clip(lib: Library, name: str) -> None:
    clip = clips.create_clip(lib, io.BytesIO(b"HIERARCHY\n"), name).clip
    assert (clip.file_name, clip.name) == ("clip", "clip")


def test_after_a_change_of_the_frame_rate_the_clip_is_analyzed_again(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    clip = upload(lib, some_demo_clips[0]).clip
    other = upload(lib, some_demo_clips[1]).clip
    work(lib.settings)
    before = clips.get_clip(lib, clip.id)
    asked = MotionQuery(QuerySource(other.id), method=Method.VECTOR)
    far = find.find_motion(lib, asked).items[0].distance
    queued = clips.update_clip(lib, clip.id, {"frame_rate": 15.0, "task": "stroll"})
    assert (queued.id, queued.state, queued.reanalysis) == (
        clip.id,
        ClipState.READY,
        Reanalysis.QUEUED,
    )
    assert find.find_motion(lib, asked).items[0].distance == far
    work(lib.settings)
    after = clips.get_clip(lib, clip.id)
    assert (after.state, after.frame_rate, after.task) == (ClipState.READY, 15.0, "stroll")
    assert after.reanalysis is None
    assert after.declared_frame_rate == before.declared_frame_rate
    assert before.duration is not None
    assert before.frame_rate is not None
    assert after.duration == pytest.approx(before.duration * before.frame_rate / 15.0)
    assert find.find_motion(lib, asked).items[0].distance != far


def test_labels_change_without_another_analysis(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    clip = upload(lib, some_demo_clips[0]).clip
    work(lib.settings)
    changed = clips.update_clip(lib, clip.id, {"person": None, "words": ["Slow"], "name": " n "})
    assert (changed.person, changed.words, changed.name) == (None, ("slow",), "n")
    assert changed.state is ClipState.READY
    for changes, location in (
        ({"state": "failed"}, "state"),
        ({"name": ""}, "name"),
        ({"frame_rate": -1}, "frame_rate"),
    ):
        with pytest.raises(BadField) as refused:
            clips.update_clip(lib, clip.id, changes)
        assert refused.value.places[0].location == location
    with pytest.raises(ClipNotFound):
        clips.update_clip(lib, "clip_none", {"name": "x"})


def test_a_removed_clip_is_in_no_search_and_its_file_is_removed(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    one, other = (upload(lib, clip).clip for clip in some_demo_clips[:2])
    work(lib.settings)
    assert find.find_motion(lib, MotionQuery(QuerySource(other.id))).items[0].clip.id == one.id
    clips.delete_clip(lib, one.id)
    assert find.find_motion(lib, MotionQuery(QuerySource(other.id))).items == ()
    with pytest.raises(ClipNotFound):
        clips.get_clip(lib, one.id)
    with pytest.raises(NotFound):
        lib.store.files.path(one.sha256)
    with pytest.raises(ClipNotFound):
        clips.delete_clip(lib, one.id)
