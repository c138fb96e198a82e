"""`kinedex worker --check` is what a container's health check runs."""

from __future__ import annotations

import os
import signal
from pathlib import Path

from app.store.jobs import owners
from app.store.workers import Heartbeat
from tests.cli.conftest import Kinedex, end, start
from tests.live import wait_until


def test_no_worker_is_unhealthy(kinedex: Kinedex, tmp_path: Path) -> None:
    checked = kinedex("worker", "--check", data_dir=tmp_path / "data")
    assert (checked.code, checked.out) == (1, "")
    assert "no worker runs here" in checked.err
    assert list(tmp_path.iterdir()) == []


def test_a_worker_elsewhere_does_not_count(kinedex: Kinedex, tmp_path: Path) -> None:
    elsewhere = Heartbeat(tmp_path / "data" / "files", "worker_a@there/kernel/ns:1:1", 5.0)
    elsewhere.beat_if_due()
    assert kinedex("worker", "--check", data_dir=tmp_path / "data").code == 1
    elsewhere.end()


def test_a_worker_that_beats_is_healthy(kinedex: Kinedex, tmp_path: Path) -> None:
    here = Heartbeat(tmp_path / "data" / "files", owners.new_owner("worker"), 5.0)
    here.beat_if_due()
    checked = kinedex("worker", "--check", data_dir=tmp_path / "data")
    assert (checked.code, checked.err) == (0, "")
    assert "last heartbeat" in checked.out
    here.end()


def test_a_worker_that_hangs_is_unhealthy_until_it_goes_on(tmp_path: Path) -> None:
    """A real worker is stopped by a signal, as if it hung."""
    settings = {"data_dir": tmp_path / "data", "job_lease_s": 4, "job_heartbeat_s": 0.2}
    (tmp_path / "data").mkdir()
    program = start("worker", **settings)

    def is_healthy() -> bool:
        return end(start("worker", "--check", **settings)).code == 0

    try:
        wait_until(is_healthy, 300.0)
        os.kill(program.pid, signal.SIGSTOP)
        wait_until(lambda: not is_healthy(), 300.0)
        checked = end(start("worker", "--check", **settings))
        assert "a worker hangs" in checked.err
        os.kill(program.pid, signal.SIGCONT)
        wait_until(is_healthy, 300.0)
        program.terminate()
        assert end(program).code == 0
        assert not is_healthy()
    finally:
        program.kill()
        program.communicate()
