"""Heartbeats tell which workers live, and which of them hang."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from app.store import workers
from app.store.files.locked_file import create_locked
from app.store.jobs import owners
from app.store.workers import Heartbeat


class Clock:
    """A clock that a test moves. now: seconds."""

    def __init__(self, now: float) -> None:
        self.now = now

    def __call__(self) -> float:
        return self.now


def test_a_worker_is_seen_from_its_first_heartbeat_until_it_ends(tmp_path: Path) -> None:
    assert workers.living(tmp_path) == ()
    heartbeat = Heartbeat(tmp_path, owners.new_owner("worker"), 5.0)
    assert workers.living(tmp_path) == ()
    heartbeat.beat_if_due()
    (found,) = workers.living(tmp_path)
    assert found.owner.startswith("worker_")
    assert found.is_here
    assert found.memory_bytes > 1_000_000
    heartbeat.end()
    assert workers.living(tmp_path) == ()
    heartbeat.end()


def test_the_age_grows_until_the_next_heartbeat(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    clock = Clock(1000.0)
    heartbeat = Heartbeat(tmp_path, "worker_a@here:1:1", 5.0, clock=clock)
    monkeypatch.setattr("time.monotonic", clock)

    def age() -> float:
        heartbeat.beat_if_due()
        (found,) = workers.living(tmp_path)
        return found.age_s

    assert age() == 0.0
    clock.now += 4.0
    assert age() == 4.0
    clock.now += 1.0
    assert age() == 0.0
    heartbeat.end()


def test_a_worker_on_another_machine_has_an_age_by_the_time_of_its_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    heartbeat = Heartbeat(tmp_path, "worker_a@there/kernel/ns:1:1", 5.0)
    heartbeat.beat_if_due()
    monkeypatch.setattr(owners, "machine", lambda: "another boot of a kernel")
    monkeypatch.setattr("time.monotonic", lambda: 1e9)
    (found,) = workers.living(tmp_path)
    assert found.age_s < 1e6
    assert not found.is_here
    heartbeat.end()


def test_a_killed_worker_is_gone_at_once(tmp_path: Path) -> None:
    code = (
        "import pathlib, sys\n"
        "from app.store.workers import Heartbeat\n"
        "heartbeat = Heartbeat(pathlib.Path(sys.argv[1]), 'worker_a@here:1:1', 5.0)\n"
        "heartbeat.beat_if_due()\n"
        "print('beats', flush=True)\n"
        "sys.stdin.read()\n"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == "beats\n"
        assert [worker.owner for worker in workers.living(tmp_path)] == ["worker_a@here:1:1"]
    finally:
        process.kill()
        process.communicate()
    assert workers.living(tmp_path) == ()
    assert list((tmp_path / workers.FOLDER).iterdir()) == []


def test_a_heartbeat_that_cannot_be_written_does_not_stop_the_worker(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / workers.FOLDER).write_text("a file in place of the folder")
    heartbeat = Heartbeat(tmp_path, "worker_a@here:1:1", 5.0)
    heartbeat.beat_if_due()
    assert "heartbeat of this worker cannot be written" in caplog.text
    heartbeat.end()


@pytest.mark.parametrize("content", [b"", b"{", b"[]", b'{"owner": "x"}'])
def test_a_file_without_a_complete_heartbeat_is_no_worker(tmp_path: Path, content: bytes) -> None:
    folder = tmp_path / workers.FOLDER
    folder.mkdir()
    _, file = create_locked(folder, "beat")
    with file:
        file.write(content)
        file.flush()
        assert workers.living(tmp_path) == ()
