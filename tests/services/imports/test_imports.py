"""Imports of folders and archives: once, twice, interrupted and canceled."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import pytest

from app.demo import DemoClip
from app.errors import Canceled, EmptyFile, LeaseLost, NotFound, TooLarge, UnknownFormat, Unreadable
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.imports import imports
from app.services.library.library import Library
from app.store.jobs import queue
from app.store.jobs.abandoned_jobs import Watch
from app.store.jobs.record import ClaimedJob, JobKind, JobState
from tests.libraries import settings_for, work
from tests.zip_archives import zip_archive


def _said(clip: DemoClip) -> str:
    return f"{clip.path},{clip.person},{clip.task},{' '.join(clip.words)},{clip.frame_rate:g}"


@pytest.fixture
def entries(some_demo_clips: list[DemoClip]) -> dict[str, bytes]:
    """Two clips with a manifest, and other files that a folder may have."""
    two = some_demo_clips[:2]
    lines = ["path,person,task,words,fps", *map(_said, two), "gone.bvh,ada,walk,,"]
    return {
        "set/manifest.csv": "\n".join(lines).encode(),
        **{f"set/{clip.path}": clip.content for clip in two},
        "set/README.md": b"# notes",
        "set/empty.bvh": b"",
        "set/cut.bvh": two[0].content[:3000],
        "set/twin.bvh": two[0].content,
    }


def _write(folder: Path, entries: dict[str, bytes]) -> Path:
    for name, content in entries.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    return folder


@pytest.mark.parametrize("first", ["walk.npy", "positions.npy"])
def test_a_zip_with_any_first_file_can_be_imported(lib: Library, first: str) -> None:
    with pytest.raises(UnknownFormat):
        imports.start_import(lib, io.BytesIO(b"\x93NUMPY" + bytes(99)), "set.zip")
    job = imports.start_import(lib, zip_archive({first: b"x", "b.bvh": b"y"}), "set.zip")
    work(lib.settings)
    assert set(_outcomes(jobs.get_job(lib, job.id).result)) == {first, "b.bvh"}


def _outcomes(result: dict[str, Any] | None) -> dict[str, str]:
    assert result is not None
    return {line["path"]: line["outcome"] for line in result["files"]}


def _claim(lib: Library) -> ClaimedJob:
    with lib.store.write() as tx:
        claimed = queue.take(tx, [JobKind.IMPORT], "test")
    assert claimed is not None
    return claimed


def test_an_archive_becomes_clips_and_every_file_has_an_outcome(
    lib: Library, entries: dict[str, bytes], some_demo_clips: list[DemoClip]
) -> None:
    job = imports.start_import(lib, zip_archive(entries), "set.zip")
    work(lib.settings)
    done = jobs.get_job(lib, job.id)
    assert done.state is JobState.SUCCEEDED
    assert done.detail is None
    first, second = some_demo_clips[:2]
    assert _outcomes(done.result) == {
        f"set/{first.path}": "ready",
        f"set/{second.path}": "ready",
        "set/README.md": "skipped",
        "set/cut.bvh": "failed",
        "set/empty.bvh": "failed",
        "set/gone.bvh": "absent",
        "set/twin.bvh": "unchanged",
    }
    assert done.result is not None
    assert {name: done.result[name] for name in ("total", "failed", "skipped", "absent")} == {
        "total": 7,
        "failed": 2,
        "skipped": 1,
        "absent": 1,
    }
    assert all(
        f["error"]["detail"] for f in done.result["files"] if f["outcome"] in ("failed", "absent")
    )
    stored = {clip.name: clip for clip in clips.list_clips(lib).items}
    clip = stored[Path(first.path).stem]
    assert (clip.person, clip.task, clip.words) == (first.person, first.task, first.words)
    assert clip.frame_rate == first.frame_rate
    assert stored["cut"].error is not None
    assert stored["cut"].error["errors"][0]["location"]


def test_the_same_folder_twice_gives_the_same_clips(
    lib: Library, entries: dict[str, bytes], tmp_path: Path
) -> None:
    folder = _write(tmp_path / "in", entries)
    seen: list[tuple[int, int, str]] = []
    first = imports.import_path(lib, folder, lambda *progress: seen.append(progress))
    assert seen[-1][0] == 6
    work(lib.settings)
    before = {c.id: c.state for c in clips.list_clips(lib).items}
    again = imports.import_path(lib, folder)
    work(lib.settings)
    assert {c.id: c.state for c in clips.list_clips(lib).items} == before
    outcomes = _outcomes(jobs.get_job(lib, first.id).result)
    assert _outcomes(jobs.get_job(lib, again.id).result) == {
        path: "unchanged" if outcome == "ready" else outcome for path, outcome in outcomes.items()
    }


def test_an_interrupted_import_continues_where_it_stopped(
    lib: Library, entries: dict[str, bytes]
) -> None:
    job = imports.start_import(lib, zip_archive(entries), "set.zip")
    claimed = _claim(lib)
    files = iter([False, False, False, True])
    with pytest.raises(Canceled):
        imports.unpack(lib, claimed, lambda *_: None, lambda: next(files))
    halfway = {clip.id for clip in clips.list_clips(lib).items}
    imports.unpack(lib, claimed, lambda *_: None, lambda: False)
    everything = {clip.id for clip in clips.list_clips(lib).items}
    assert halfway < everything
    assert len(everything) == 3
    assert jobs.get_job(lib, job.id).state is JobState.PROCESSING


def test_an_import_given_to_another_worker_stores_nothing_more(
    lib: Library, entries: dict[str, bytes]
) -> None:
    imports.start_import(lib, zip_archive(entries), "set.zip")
    with lib.store.write() as tx:
        old = queue.take(tx, [JobKind.IMPORT], "old")
        watch = Watch("watcher", 0.0)  # by it the worker "old" is dead
        queue.recover(tx, watch, watch.look(tx))
    assert old is not None
    _claim(lib)
    with pytest.raises(LeaseLost):
        imports.unpack(lib, old, lambda *_: None, lambda: False)
    assert clips.list_clips(lib).items == ()


def test_a_repeated_name_in_an_archive_is_imported_beside_the_first(
    lib: Library, some_demo_clips: list[DemoClip], recwarn: pytest.WarningsRecorder
) -> None:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("a.bvh", some_demo_clips[0].content)
        with pytest.warns(UserWarning, match="Duplicate"):
            archive.writestr("a.bvh", some_demo_clips[1].content)
    made.seek(0)
    imports.start_import(lib, made, "twice.zip")
    imports.unpack(lib, _claim(lib), lambda *_: None, lambda: False)
    assert len(clips.list_clips(lib).items) == 2


def test_an_archive_that_cannot_be_used_fails_with_its_reason(lib: Library) -> None:
    bad = imports.start_import(lib, io.BytesIO(b"PK\x03\x04 but no more"), "bad.zip")
    odd = imports.start_import(
        lib, zip_archive({"manifest.csv": b"name\nx\n", "a.bvh": b"H"}), "odd.zip"
    )
    work(lib.settings)
    errors = [jobs.get_job(lib, job.id).error for job in (bad, odd)]
    assert [error and error["code"] for error in errors] == ["unreadable", "unreadable"]


def test_a_file_that_is_no_archive_is_refused_at_once(lib: Library, tmp_path: Path) -> None:
    with pytest.raises(EmptyFile):
        imports.start_import(lib, io.BytesIO(b""), "a.zip")
    with pytest.raises(UnknownFormat):
        imports.start_import(lib, io.BytesIO(b"HIERARCHY\n"), "a.bvh")
    with pytest.raises(NotFound):
        imports.import_path(lib, tmp_path / "nowhere")


def test_an_archive_over_the_limit_is_refused_at_once(tmp_path: Path) -> None:
    lib = Library.open(settings_for(tmp_path, max_archive_bytes=100))
    with pytest.raises(TooLarge):
        imports.start_import(lib, zip_archive({"a.bvh": bytes(range(256))}), "a.zip")
    lib.close()


def test_a_file_or_an_archive_can_be_imported_from_disk(
    lib: Library, some_demo_clips: list[DemoClip], tmp_path: Path
) -> None:
    one, other = some_demo_clips[:2]
    _write(
        tmp_path,
        {"one.bvh": one.content, "other.zip": zip_archive({"b.bvh": other.content}).read()},
    )
    imports.import_path(lib, tmp_path / "one.bvh")
    imports.import_path(lib, tmp_path / "other.zip")
    assert {clip.name for clip in clips.list_clips(lib).items} == {"one", "b"}


@pytest.mark.parametrize("compression", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_damaged_file_in_an_archive_does_not_stop_the_others(
    lib: Library, some_demo_clips: list[DemoClip], compression: int
) -> None:
    one, other = (clip.content for clip in some_demo_clips[:2])
    content = bytearray(zip_archive({"bad.bvh": one, "good.bvh": other}, compression).getvalue())
    for place in range(300, 2000):
        content[place] ^= 0x5A
    job = imports.start_import(lib, io.BytesIO(bytes(content)), "a.zip")
    imports.unpack(lib, _claim(lib), lambda *_: None, lambda: False)
    assert [clip.name for clip in clips.list_clips(lib).items] == ["good"]
    work(lib.settings)
    done = jobs.get_job(lib, job.id)
    assert _outcomes(done.result) == {"bad.bvh": "failed", "good.bvh": "ready"}


def test_a_damaged_manifest_fails_the_whole_import(lib: Library) -> None:
    content = bytearray(
        zip_archive({"manifest.csv": b"path,person\n" + b"a.bvh,ada\n" * 99}).getvalue()
    )
    for place in range(45, 60):
        content[place] ^= 0x5A
    imports.start_import(lib, io.BytesIO(bytes(content)), "a.zip")
    with pytest.raises(Unreadable, match=r"manifest\.csv"):
        imports.unpack(lib, _claim(lib), lambda *_: None, lambda: False)


def test_the_demo_library_is_generated_by_the_worker(
    lib: Library, some_demo_clips: list[DemoClip], monkeypatch: pytest.MonkeyPatch
) -> None:
    few = some_demo_clips[:2]

    def write(folder: Path) -> int:
        for clip in few:
            (folder / clip.path.replace("/", "_")).write_bytes(clip.content)
        return len(few)

    monkeypatch.setattr("app.demo.library.write_demo", write)
    job = imports.start_demo(lib)
    assert imports.start_demo(lib).id == job.id
    work(lib.settings)
    ended = jobs.get_job(lib, job.id)
    assert ended.state is JobState.SUCCEEDED
    assert (ended.result or {})["new"] == len(few)
    again = imports.start_demo(lib)
    assert again.id != job.id
    work(lib.settings)
    assert (jobs.get_job(lib, again.id).result or {})["unchanged"] == len(few)
