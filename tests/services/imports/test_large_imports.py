"""Large imports: they have limits, take turns, and list their files in pages."""

from __future__ import annotations

import io
import itertools
import json
import zipfile
from collections import Counter
from types import SimpleNamespace
from typing import Any

import pytest

from app.demo import DemoClip
from app.errors import Conflict, PageNotFound, TooLarge
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.clips.jobs import FIRST_FILES
from app.services.imports import imports
from app.services.imports import register as import_register
from app.services.imports.plan import MAX_ABSENT_LISTED
from app.services.library.library import Library
from app.store.jobs import queue
from app.store.jobs.import_files import FileOutcome
from app.store.jobs.record import ClaimedJob, JobKind, JobRecord, JobState
from tests.libraries import settings_for, work
from tests.zip_archives import zip_archive


def _claim(lib: Library) -> ClaimedJob:
    with lib.store.write() as tx:
        claimed = queue.take(tx, [JobKind.IMPORT], "test")
    assert claimed is not None
    return claimed


def _unpack(lib: Library, claimed: ClaimedJob) -> JobRecord:
    imports.unpack(lib, claimed, lambda *_: None, lambda: False)
    return jobs.get_job(lib, claimed.job.id)


def _bad(count: int) -> list[tuple[str, bytes]]:
    """Different files that become clips and fail in their analysis."""
    return [(f"bad_{i:03d}.bvh", f"HIERARCHY\nROOT {i}\n".encode()) for i in range(count)]


def _manifest(rows: int) -> tuple[str, bytes]:
    return "manifest.csv", b"path\n" + b"".join(b"gone_%06d.bvh\n" % i for i in range(rows))


def test_missing_files_of_a_manifest_are_counted_and_the_first_are_listed(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    good = ("here.bvh", some_demo_clips[0].content)
    imports.start_import(lib, zip_archive([good, _manifest(5000)]), "a.zip")
    job = _unpack(lib, _claim(lib))
    assert job.state is JobState.PROCESSING
    work(lib.settings)
    job = jobs.get_job(lib, job.id)
    assert job.result is not None
    assert (job.result["total"], job.result["absent"], job.result["new"]) == (5001, 5000, 1)
    absent = list(jobs.all_files(lib, job.id, FileOutcome.ABSENT))
    assert [file.path for file in absent] == [f"gone_{i:06d}.bvh" for i in range(MAX_ABSENT_LISTED)]
    assert absent[0].error is not None
    assert absent[0].error["errors"][0]["location"] == "manifest.csv line 2"


def test_rows_of_absent_paths_count_against_the_limit_of_entries(tmp_path: Any) -> None:
    lib = Library.open(settings_for(tmp_path, max_archive_entries=50))
    clip = _bad(1)[0]
    imports.start_import(lib, zip_archive([clip, _manifest(51)]), "a.zip")
    with pytest.raises(TooLarge, match="line 52: more than 50 rows") as refused:
        _unpack(lib, _claim(lib))
    assert refused.value.places[0].location == "manifest.csv line 52"
    assert clips.list_clips(lib).items == ()
    lib.close()


def test_the_result_of_a_large_import_is_small_and_its_files_are_paged(lib: Library) -> None:
    names = [f"{i:04d}.bvh" for i in range(1200)]
    imports.start_import(lib, zip_archive((name, b"") for name in names), "a.zip")
    job = _unpack(lib, _claim(lib))
    assert job.result is not None
    assert (job.result["total"], job.result["failed"]) == (1200, 1200)
    assert [line["path"] for line in job.result["files"]] == names[:FIRST_FILES]
    assert job.result["files_left_out"] == 1100
    (listed,) = jobs.list_jobs(lib).items
    assert listed.result is not None
    assert "files" not in listed.result
    assert len(json.dumps(listed.result)) < 200
    page = jobs.list_files(lib, job.id, limit=700)
    again = jobs.list_files(lib, job.id, limit=700, cursor=page.next)
    assert [file.path for file in (*page.items, *again.items)] == names
    assert again.next is None
    assert jobs.list_files(lib, job.id, FileOutcome.READY).items == ()
    with pytest.raises(PageNotFound):
        jobs.list_files(lib, job.id, cursor="nonsense")


def test_the_result_lists_failed_files_first(lib: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(jobs, "FIRST_FILES", 3)
    files = [*_bad(4), ("z_empty.bvh", b""), ("y_notes.bvh", b"notes")]
    imports.start_import(lib, zip_archive(files), "a.zip")
    _unpack(lib, claimed := _claim(lib))
    for clip in clips.list_clips(lib).items:
        clips.delete_clip(lib, clip.id)
    job = jobs.get_job(lib, claimed.job.id)
    assert job.result is not None
    listed = [(line["path"], line["outcome"]) for line in job.result["files"]]
    assert listed == [
        ("bad_000.bvh", "deleted"),
        ("y_notes.bvh", "failed"),
        ("z_empty.bvh", "failed"),
    ]


def test_files_without_a_clip_are_recorded_together(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(import_register, "RECORD_AFTER_S", 1e9)
    writes = Counter[str]()
    write = lib.store.database.write

    def counted() -> Any:
        writes["write"] += 1
        return write()

    imports.start_import(lib, zip_archive((f"{i:04d}.bvh", b"") for i in range(1200)), "a.zip")
    claimed = _claim(lib)
    monkeypatch.setattr(lib.store.database, "write", counted)
    _unpack(lib, claimed)
    # beside the entries: the end of the import, and the removal of its archive
    assert writes["write"] <= 1200 / import_register.MAX_PROBLEMS_TOGETHER + 3


def test_small_files_that_are_no_motion_are_not_written_to_disk(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = [("empty.bvh", b""), ("notes.txt", b"notes\n" * 10_000), ("good.bvh", _bad(1)[0][1])]
    imports.start_import(lib, zip_archive(files), "a.zip")
    claimed, staged = _claim(lib), list[int]()
    stage = type(lib.store.files).stage

    def counted(*args: Any, **options: Any) -> Any:
        staged.append(1)
        return stage(*args, **options)

    monkeypatch.setattr(type(lib.store.files), "stage", counted)
    _unpack(lib, claimed)
    assert len(staged) == 1
    codes = {f.path: (f.error or {}).get("code") for f in jobs.all_files(lib, claimed.job.id)}
    assert codes == {"empty.bvh": "empty_file", "notes.txt": "unknown_format", "good.bvh": None}


def _end_turns_with_each_file(monkeypatch: pytest.MonkeyPatch) -> None:
    """A clock that advances by the length of a turn with each reading."""
    ticks = itertools.count(step=imports.TURN_S)
    monkeypatch.setattr(imports, "time", SimpleNamespace(monotonic=ticks.__next__))


def test_an_import_lets_another_import_run_and_continues_later(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    _end_turns_with_each_file(monkeypatch)
    large = imports.start_import(lib, zip_archive(_bad(3)), "large.zip")
    claimed = _claim(lib)
    small = imports.start_import(
        lib, zip_archive([("small.bvh", b"HIERARCHY\nROOT s\n")]), "small.zip"
    )
    waiting = _unpack(lib, claimed)
    assert (waiting.state, waiting.progress) == (JobState.QUEUED, pytest.approx(1 / 3))
    assert waiting.detail == "1 of 3 files; waiting for other imports"
    following = _claim(lib)
    assert following.job.id == small.id
    _unpack(lib, following)
    again = _claim(lib)
    assert again.job.id == large.id
    assert (again.failures, again.kills, again.worker_deaths) == (0, 0, 0)
    done = _unpack(lib, again)
    assert done.state is JobState.PROCESSING
    assert len(list(jobs.all_files(lib, large.id))) == 3
    assert len(clips.list_clips(lib).items) == 4


def test_a_single_import_runs_without_a_break(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    _end_turns_with_each_file(monkeypatch)
    imports.start_import(lib, zip_archive(_bad(3)), "a.zip")
    assert _unpack(lib, _claim(lib)).state is JobState.PROCESSING


def test_an_import_can_be_canceled_between_its_turns(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    _end_turns_with_each_file(monkeypatch)
    large = imports.start_import(lib, zip_archive(_bad(3)), "large.zip")
    claimed = _claim(lib)
    imports.start_import(lib, zip_archive(_bad(4)[3:]), "small.zip")
    assert _unpack(lib, claimed).state is JobState.QUEUED
    canceled = jobs.cancel_or_remove(lib, large.id)
    assert canceled is not None
    assert canceled.state is JobState.CANCELED
    (clip,) = clips.list_clips(lib).items
    assert clip.error is not None
    assert clip.error["code"] == "canceled"


def test_clips_of_a_small_import_go_before_those_of_a_large_one(
    lib: Library, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(import_register, "FIRST_CLIPS", 2)
    imports.start_import(lib, zip_archive(_bad(9)), "large.zip")
    _unpack(lib, _claim(lib))
    imports.start_import(lib, zip_archive([("small.bvh", b"HIERARCHY\nROOT s\n")]), "small.zip")
    _unpack(lib, _claim(lib))
    order = []
    with lib.store.write() as tx:
        while claimed := queue.take(tx, [JobKind.INGEST], "test"):
            order.append(claimed.clip_id or "")
        names = {clip.id: clip.name for clip in clips.stored.get_many(tx, order).values()}
    assert [names[clip_id] for clip_id in order].index("small") == 1


def test_a_too_long_path_is_refused_and_repeated_names_do_not_collide(
    lib: Library, recwarn: pytest.WarningsRecorder
) -> None:
    long = "x" * 3000 + ".bvh"
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for name in ("a.bvh", "a.bvh (2)", long):
            archive.writestr(name, b"")
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("a.bvh", b"")
    made.seek(0)
    imports.start_import(lib, made, "a.zip")
    job = _unpack(lib, _claim(lib))
    files = list(jobs.all_files(lib, job.id))
    assert [file.path for file in files[:3]] == ["a.bvh", "a.bvh (2)", "a.bvh (3)"]
    assert len(files[3].path) <= 500
    assert files[3].error is not None
    assert files[3].error["detail"] == "The path is too long."


@pytest.mark.parametrize("letter", ["é", "\N{GRINNING FACE}", "\x01", '"'])
def test_a_cursor_after_a_long_path_is_accepted(lib: Library, letter: str) -> None:
    names = [letter * 490 + f"{i}.bvh" for i in range(3)]
    imports.start_import(lib, zip_archive((name, b"") for name in names), "a.zip")
    job = _unpack(lib, _claim(lib))
    page = jobs.list_files(lib, job.id, limit=2)
    rest = jobs.list_files(lib, job.id, limit=2, cursor=page.next)
    assert len(page.items) + len(rest.items) == 3


def test_a_job_that_has_ended_can_be_removed_with_its_files_but_not_its_clips(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    job = imports.start_import(lib, zip_archive([("a.bvh", some_demo_clips[0].content)]), "a.zip")
    work(lib.settings)
    assert jobs.cancel_or_remove(lib, job.id) is None
    assert job.id not in {one.id for one in jobs.list_jobs(lib).items}
    with lib.store.read() as tx:
        assert imports.stored.recorded_paths(tx, job.id) == frozenset()
    assert len(clips.list_clips(lib).items) == 1


def test_the_newest_fit_is_not_removed(ready_library: Library) -> None:
    (fit, *_) = jobs.list_jobs(ready_library, kind=JobKind.FIT, state=JobState.SUCCEEDED).items
    with pytest.raises(Conflict):
        jobs.cancel_or_remove(ready_library, fit.id)
