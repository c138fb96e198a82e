"""A disk that cannot be written, or that is full: nothing is lost, and work goes on by itself."""

from __future__ import annotations

import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import httpx2
import pytest

from app.config import Settings
from app.demo import DemoClip, demo_clips
from app.errors import StorageError
from app.services.clips import catalogue as clips
from app.services.library.library import Library
from app.store.clips.record import ClipState
from app.worker.loop import run_worker
from tests.api.conftest import assert_problem
from tests.full_disk import fill, small_disk
from tests.libraries import settings_for, upload
from tests.live import NET_S, Live, serve, wait_until


@pytest.fixture(scope="module")
def kicks() -> list[DemoClip]:
    return list(demo_clips(("ada",), ("kick",), takes=2))


@contextmanager
def read_only(folder: Path) -> Iterator[None]:
    """The folder on a mount that cannot be written, as a disk after an error; the end undoes it."""
    _mount("--bind", str(folder), str(folder))
    try:
        _mount("-o", "remount,bind,ro", str(folder))
        yield
    finally:
        subprocess.run(["umount", "--lazy", str(folder)], check=True)


def _mount(*words: str) -> None:
    try:
        done = subprocess.run(["mount", *words], capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("SKIPPED: no test of a read-only disk, because there is no program mount")
    if done.returncode:
        pytest.skip(f"SKIPPED: no test of a read-only disk: {done.stderr.strip()}")


def test_a_disk_that_becomes_read_only_while_the_service_runs(
    tmp_path: Path, kicks: list[DemoClip]
) -> None:
    first, second = kicks
    with serve(tmp_path / "data") as live, live.client() as client:
        stored = live.upload(first).json()["clip"]["id"]
        with read_only(live.data_dir):
            wait_until(lambda: client.get("/readyz").status_code == 503, NET_S)
            assert_problem(client.get("/readyz"), 503, "unhealthy", "disk")
            assert_problem(live.upload(second), 500, "storage")
            assert client.get(f"/v1/clips/{stored}").status_code == 200
            assert client.get(f"/v1/clips/{stored}/file").content == first.content
        wait_until(lambda: client.get("/readyz").status_code == 200, NET_S)
        assert live.upload(second).status_code == 202
        assert _count(client) == 2


def test_a_library_on_a_read_only_disk_is_refused_at_the_start(
    tmp_path: Path, kicks: list[DemoClip]
) -> None:
    settings = settings_for(tmp_path)
    lib = Library.open(settings)
    upload(lib, kicks[0])
    lib.close()
    with read_only(settings.data_dir), pytest.raises(StorageError) as refused:
        Library.open(settings).close()
    assert "cannot be" in refused.value.detail
    again = Library.open(settings)
    assert len(clips.list_clips(again).items) == 1
    again.close()


def test_a_worker_goes_on_by_itself_when_there_is_room_again(
    tmp_path: Path, kicks: list[DemoClip]
) -> None:
    with small_disk(tmp_path / "disk", 24) as disk:
        settings = settings_for(disk, job_max_attempts=1)
        lib = Library.open(settings)
        for clip in kicks:
            upload(lib, clip)
        filler = fill(disk)
        with _worker(settings):
            # Longer than a retry: a full disk must not use up the attempts of a clip.
            wait_until(lambda: _is_full(lib, kicks[0]), NET_S)
            threading.Event().wait(3.0)
            assert {clip.state for clip in clips.list_clips(lib).items} <= {
                ClipState.QUEUED,
                ClipState.PROCESSING,
            }
            filler.unlink()
            wait_until(
                lambda: {clip.state for clip in clips.list_clips(lib).items} == {ClipState.READY},
                NET_S,
            )
        lib.close()


def _is_full(lib: Library, clip: DemoClip) -> bool:
    try:
        upload(lib, replace(clip, content=clip.content + b"\n" * 200_000))
    except StorageError:
        return True
    return False


@contextmanager
def _worker(settings: Settings) -> Iterator[None]:
    stop = threading.Event()
    thread = threading.Thread(target=run_worker, args=(settings, stop))
    thread.start()
    try:
        yield
    finally:
        stop.set()
        thread.join()


def test_two_services_share_one_directory(tmp_path: Path, kicks: list[DemoClip]) -> None:
    first, second = kicks
    with (
        serve(tmp_path / "data", worker=True) as one,
        serve(tmp_path / "data") as other,
        one.client() as here,
        other.client() as there,
    ):
        answers = [_upload_together(one, other, clip) for clip in (first, second)]
        for pair in answers:
            assert len({answer["clip"]["id"] for answer in pair}) == 1  # the same bytes: once
            job = next(answer["job"] for answer in pair if answer["job"])
            assert one.wait_for_job(job["id"])["state"] == "succeeded"
        assert _count(here) == _count(there) == 2
        ids = [pair[0]["clip"]["id"] for pair in answers]
        for client in (here, there):
            hits = client.post("/v1/search/motion", json={"clip_id": ids[0]}).json()["items"]
            assert [hit["clip"]["id"] for hit in hits] == [ids[1]]
        assert here.delete(f"/v1/clips/{ids[1]}").status_code == 204
        assert there.get(f"/v1/clips/{ids[1]}").status_code == 404


def _upload_together(one: Live, other: Live, clip: DemoClip) -> list[dict[str, dict[str, str]]]:
    """The same clip, sent to both services at the same time."""
    found: list[dict[str, dict[str, str]]] = []
    threads = [
        threading.Thread(target=lambda live=live: found.append(live.upload(clip).json()))
        for live in (one, other)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return found


def _count(client: httpx2.Client) -> int:
    return len(client.get("/v1/clips").json()["items"])
