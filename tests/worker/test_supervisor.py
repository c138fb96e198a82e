"""The supervisor keeps processes running, and ends all if one of them cannot start."""

from __future__ import annotations

import os
import signal
import socket
import sqlite3
import subprocess
import sys
import threading
from pathlib import Path

import psutil
import pytest

from app.config import Settings
from app.services.exposure import CANNOT_START
from app.worker import supervisor
from app.worker.api_processes import API
from app.worker.supervised import SupervisedProcess
from app.worker.supervisor import environment, keep_running
from tests.live import wait_until

TIMEOUT_S = 120.0
SLEEPER = "import os, sys, time; open(sys.argv[1], 'a').write(f'{os.getpid()}\\n'); time.sleep(60)"


def _kept(log: Path) -> SupervisedProcess:
    return SupervisedProcess("sleeper", ("-c", SLEEPER, str(log)))


def _pids(log: Path) -> list[int]:
    return [int(line) for line in log.read_text().splitlines()] if log.exists() else []


def test_a_process_that_is_killed_is_started_again_and_ended_with_the_rest(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(supervisor, "FIRST_DELAY_S", 0.05)
    log, stop, codes = tmp_path / "pids", threading.Event(), []
    kept = [_kept(log)]
    thread = threading.Thread(
        target=lambda: codes.append(keep_running(kept, dict(os.environ), stop))
    )
    thread.start()
    wait_until(lambda: len(_pids(log)) == 1, TIMEOUT_S)
    os.kill(_pids(log)[0], signal.SIGKILL)
    wait_until(lambda: len(_pids(log)) == 2, TIMEOUT_S)
    stop.set()
    thread.join(300)
    assert codes == [0]
    assert not any(psutil.pid_exists(pid) for pid in _pids(log))


def test_a_process_that_cannot_start_ends_all_processes(tmp_path: Path) -> None:
    ending = f"import sys, time; time.sleep(1); sys.exit({CANNOT_START})"
    hopeless = SupervisedProcess("hopeless", ("-c", ending))
    log = tmp_path / "pids"
    assert keep_running([_kept(log), hopeless], dict(os.environ), threading.Event()) == CANNOT_START
    assert not any(psutil.pid_exists(pid) for pid in _pids(log))


@pytest.mark.parametrize("code", [1, 2, 3, 255])
def test_a_process_that_crashes_early_is_started_again(code: int) -> None:
    one = SupervisedProcess("crasher", ("-c", f"import sys; sys.exit({code})"))
    for _ in range(2):
        one.next_start = 0.0
        assert supervisor._look_after(one, dict(os.environ)) is None
        assert one.process is not None
        one.process.wait()
        assert supervisor._look_after(one, dict(os.environ)) is None
    assert one.process is None


def test_each_early_death_doubles_the_delay(monkeypatch: pytest.MonkeyPatch) -> None:
    one = SupervisedProcess("dier", ("-c", "import os; os.kill(os.getpid(), 9)"))
    delays = []
    for _ in range(3):
        one.next_start = 0.0
        assert supervisor._look_after(one, dict(os.environ)) is None
        assert one.process is not None
        one.process.wait()
        delays.append(one.delay)
        assert supervisor._look_after(one, dict(os.environ)) is None
    assert delays == [0.5, 1.0, 2.0]


def _database_of_another_version(folder: Path) -> None:
    folder.mkdir()
    with sqlite3.connect(folder / "kinedex.sqlite3") as database:
        database.execute("CREATE TABLE alembic_version (version_num VARCHAR(32) NOT NULL)")
        database.execute("INSERT INTO alembic_version VALUES ('9999')")
    database.close()


@pytest.mark.parametrize("arguments", [API, supervisor.WORKER], ids=["api", "worker"])
def test_no_process_starts_on_a_database_of_another_version(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    _database_of_another_version(tmp_path / "data")
    environ = os.environ | {"KINEDEX_DATA_DIR": str(tmp_path / "data"), "KINEDEX_PORT": "0"}
    ended = subprocess.run(
        [sys.executable, *arguments], env=environ, capture_output=True, text=True, check=False
    )
    assert (ended.returncode, "newer Kinedex" in ended.stderr) == (CANNOT_START, True)


def test_a_port_in_use_ends_the_api(tmp_path: Path) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        environ = os.environ | {
            "KINEDEX_DATA_DIR": str(tmp_path / "data"),
            "KINEDEX_PORT": str(taken.getsockname()[1]),
        }
        command = [sys.executable, *API]
        ended = subprocess.run(command, env=environ, capture_output=True, text=True, check=False)
    assert (ended.returncode, "cannot listen" in ended.stderr) == (CANNOT_START, True)


SUPERVISOR = """
import os, sys, threading
from pathlib import Path
from app.worker.supervised import SupervisedProcess
from app.worker.supervisor import keep_running
sleeper = SupervisedProcess("sleeper", ("-c", sys.argv[2], sys.argv[1]))
keep_running([sleeper], dict(os.environ), threading.Event())
"""


def test_a_killed_supervisor_leaves_nothing_behind(tmp_path: Path) -> None:
    log = tmp_path / "pids"
    command = [sys.executable, "-c", SUPERVISOR, str(log), SLEEPER]
    with subprocess.Popen(command) as process:
        wait_until(lambda: len(_pids(log)) == 1, TIMEOUT_S)
        process.kill()
    wait_until(lambda: not _is_running(_pids(log)[0]), TIMEOUT_S)


def _is_running(pid: int) -> bool:
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False


def test_all_settings_reach_the_processes(tmp_path: Path) -> None:
    settings = Settings(
        data_dir=tmp_path,
        port=8123,
        require_keys=True,
        database_url="sqlite:///x.sqlite3",
        trusted_proxies="10.0.0.1, 10.0.0.2",
    )
    variables = environment(settings)
    assert variables["KINEDEX_DATA_DIR"] == str(tmp_path)
    assert variables["KINEDEX_PORT"] == "8123"
    assert variables["KINEDEX_REQUIRE_KEYS"] == "true"
    assert variables["KINEDEX_DATABASE_URL"] == "sqlite:///x.sqlite3"
    assert variables["KINEDEX_TRUSTED_PROXIES"] == "10.0.0.1,10.0.0.2"


@pytest.mark.parametrize("arguments", [API, supervisor.WORKER], ids=["api", "worker"])
def test_a_folder_named_app_in_the_working_directory_is_ignored(
    arguments: tuple[str, ...], tmp_path: Path
) -> None:
    (tmp_path / "app").mkdir()
    (tmp_path / "app" / "__init__.py").touch()
    ended = subprocess.run(
        [sys.executable, *arguments],
        cwd=tmp_path,
        env={**os.environ, "KINEDEX_PORT": "none"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == CANNOT_START
    assert "KINEDEX_PORT" in ended.stderr
