"""The archive of an import is removed when no import needs it, by any process."""

from __future__ import annotations

import io
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.demo import DemoClip, demo_clips
from app.errors import FileDamaged
from app.services.clips import catalogue as clips
from app.services.clips import jobs
from app.services.imports import imports
from app.services.library.library import Library
from app.store.clips.record import ClipState
from app.store.jobs.record import JobState
from app.worker.sweeps import Sweeps
from tests.libraries import settings_for, upload, work
from tests.live import NET_S, wait_until
from tests.zip_archives import zip_archive


@pytest.fixture
def lib(tmp_path: Path) -> Iterator[Library]:
    opened = Library.open(settings_for(tmp_path, job_max_attempts=1))
    yield opened
    opened.close()


@pytest.fixture(scope="module")
def some_demo_clips() -> list[DemoClip]:
    return list(demo_clips(("ada",), ("walk", "wave"), takes=1))


def _archive(*demo: DemoClip) -> io.BytesIO:
    manifest = f"path,person\n{demo[0].path},Zebulon Quatermain\n".encode()
    return zip_archive({clip.path: clip.content for clip in demo} | {"manifest.csv": manifest})


def stored(lib: Library) -> set[str]:
    return set(lib.store.files)


def test_an_archive_is_removed_while_the_worker_runs(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    demo = some_demo_clips[:2]
    job = imports.start_import(lib, _archive(*demo), "demo.zip")
    (archive,) = stored(lib)
    work(lib.settings)
    assert jobs.get_job(lib, job.id).state is JobState.SUCCEEDED
    found = clips.list_clips(lib).items
    assert stored(lib) == {clip.sha256 for clip in found}
    assert archive not in stored(lib)
    for clip in found:
        clips.delete_clip(lib, clip.id)
    assert stored(lib) == set()
    assert list(lib.store.files.quarantine) == []


def test_an_archive_is_removed_when_the_api_cancels_its_import(
    lib: Library, some_demo_clips: list[DemoClip]
) -> None:
    job = imports.start_import(lib, _archive(some_demo_clips[0]), "demo.zip")
    assert len(stored(lib)) == 1
    jobs.cancel_or_remove(lib, job.id)
    assert stored(lib) == set()


def test_a_damaged_file_is_not_analyzed(lib: Library, some_demo_clips: list[DemoClip]) -> None:
    """With one changed digit the file is another motion, and no reader can see that."""
    clip = upload(lib, some_demo_clips[0]).clip
    path = lib.store.files.path(clip.sha256)
    content = bytearray(path.read_bytes())
    last_digit = max(content.rfind(digit) for digit in (b"1", b"2", b"3"))
    content[last_digit] ^= 1
    path.write_bytes(content)
    work(lib.settings)
    failed = clips.get_clip(lib, clip.id)
    assert failed.state is ClipState.FAILED
    assert (failed.error or {})["code"] == FileDamaged.code


def test_the_worker_sweeps_again_and_again(lib: Library, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.worker.sweeps.SWEEP_INTERVAL_S", 0.05)
    sweeps = Sweeps(lib.store, 30.0)
    sweeps.begin()
    try:
        with lib.store.files.stage(io.BytesIO(b"kept, but never committed")) as staged:
            staged.keep()
        wait_until(lambda: list(lib.store.files.quarantine) == [staged.sha256], NET_S)
    finally:
        sweeps.end()
