"""A process that parses files can compute, and nothing else."""

from __future__ import annotations

import importlib
import multiprocessing
import os
import re
import signal
import socket
import subprocess
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import psutil
import pytest

from app.services.children import landlock, sandbox
from app.services.children.child import ChildEnded
from app.services.children.given_files import open_given
from app.services.children.pool import ChildPool
from app.services.children.processes import LIBRARIES, child_context
from app.services.children.sandbox import MAX_OPEN_FILES, Sandbox, SandboxStatus, limit_cpu
from tests.live import wait_until

NET_S = 240.0
needs_walls = pytest.mark.skipif(
    bool(sandbox.status().missing), reason="this kernel has no Landlock or no seccomp"
)


def _enter(box: Sandbox) -> None:
    box.enter(4096)


@pytest.fixture
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.delenv(sandbox.NUMBA_CACHE, raising=False)
    return tmp_path / "cache"


@pytest.fixture
def pool(cache: Path) -> Iterator[ChildPool]:
    box = Sandbox.of_this_program(cache)
    box.make_folders()
    opened = ChildPool(1, _enter, box)
    yield opened
    opened.close()


def _read(path: str) -> bytes:
    return Path(path).read_bytes()


def _read_given(path: str) -> bytes:
    with open_given(path) as file:
        return file.read()


def _write(path: str) -> None:
    Path(path).write_text("x")


def _connect(port: int) -> None:
    socket.create_connection(("127.0.0.1", port), timeout=10).close()


def _open_socket(family: int, kind: int) -> None:
    socket.socket(family, kind).close()


def _fork() -> None:
    if os.fork() == 0:
        os._exit(0)


def _run_program() -> None:
    subprocess.run([sys.executable, "-c", ""], check=True)


def _stop(pid: int) -> None:
    os.kill(pid, signal.SIGTERM)


def _open_many(path: str) -> int:
    files = []
    try:
        while len(files) < 10_000:
            files.append(os.open(path, os.O_RDONLY))
    except OSError:
        return len(files)
    finally:
        for file in files:
            os.close(file)
    return len(files)


def _warnings_of_import(name: str) -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        importlib.import_module(name)
    return [str(one.message) for one in caught if issubclass(one.category, UserWarning)]


def _run_thread() -> int:
    found: list[int] = []
    thread = threading.Thread(target=found.append, args=(1,))
    thread.start()
    thread.join()
    return found[0]


@needs_walls
def test_other_files_cannot_be_opened(pool: ChildPool, tmp_path: Path, cache: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_bytes(b"of another clip")
    for path in ("/etc/passwd", str(secret), f"/proc/{os.getpid()}/environ"):
        with pytest.raises(PermissionError):
            pool.submit(_read, path).result(NET_S)
    for path in (secret, tmp_path / "new", Path(os.__file__)):
        with pytest.raises(PermissionError):
            pool.submit(_write, str(path)).result(NET_S)
    for list_folder in ("/", "/tmp", str(tmp_path)):
        with pytest.raises(PermissionError):
            pool.submit(os.listdir, list_folder).result(NET_S)
    pool.submit(_write, str(cache / "compiled")).result(NET_S)
    assert (cache / "compiled").read_text() == "x"


@needs_walls
def test_only_the_files_of_the_task_can_be_opened(pool: ChildPool, tmp_path: Path) -> None:
    first, second = tmp_path / "first", tmp_path / "second"
    first.write_bytes(b"1"), second.write_bytes(b"2")
    assert pool.submit(_read_given, str(first), files=[str(first)]).result(NET_S) == b"1"
    assert (
        pool.submit(_read_given, str(second), files=[str(first), str(second)]).result(NET_S) == b"2"
    )
    with pytest.raises(PermissionError):
        pool.submit(_read_given, str(first), files=[str(second)]).result(NET_S)
    with pytest.raises(FileNotFoundError):
        pool.submit(_read_given, "x", files=[str(tmp_path / "missing")]).result(NET_S)
    assert pool.submit(sum, [1]).result(NET_S) == 1


@needs_walls
def test_there_is_no_network(pool: ChildPool) -> None:
    with socket.create_server(("127.0.0.1", 0)) as server, pytest.raises(PermissionError):
        pool.submit(_connect, server.getsockname()[1]).result(NET_S)
    for family, kind in (
        (socket.AF_INET, socket.SOCK_DGRAM),
        (socket.AF_INET6, socket.SOCK_STREAM),
        (socket.AF_UNIX, socket.SOCK_STREAM),
    ):
        with pytest.raises(PermissionError):
            pool.submit(_open_socket, family, kind).result(NET_S)


@needs_walls
def test_no_process_is_started_or_stopped(pool: ChildPool) -> None:
    with subprocess.Popen(["sleep", str(NET_S)]) as other:
        for work in (_fork, _run_program, partial(_stop, other.pid)):
            with pytest.raises(PermissionError):
                pool.submit(work).result(NET_S)
        assert other.poll() is None
        other.kill()
    assert pool.submit(_run_thread).result(NET_S) == 1


def test_open_files_are_limited(pool: ChildPool) -> None:
    assert 0 < pool.submit(_open_many, os.devnull).result(NET_S) < MAX_OPEN_FILES


def test_the_libraries_that_hear_music_start_without_a_warning(pool: ChildPool) -> None:
    pytest.importorskip("librosa")
    assert pool.submit(_warnings_of_import, "joblib").result(NET_S) == []


def test_memory_is_limited(pool: ChildPool) -> None:
    with pytest.raises(MemoryError):
        pool.submit(bytes, 2**33).result(NET_S)


@needs_walls
def test_the_network_is_refused_without_the_filter_too(cache: Path) -> None:
    """On a processor whose system calls we do not know, Landlock still refuses TCP."""
    pool = ChildPool(1, _enter_without_filter, Sandbox.of_this_program(cache))
    with socket.create_server(("127.0.0.1", 0)) as server, pytest.raises(PermissionError):
        pool.submit(_connect, server.getsockname()[1]).result(NET_S)
    with pytest.raises(PermissionError):
        pool.submit(_read, "/etc/passwd").result(NET_S)
    pool.close()


def _enter_without_filter(box: Sandbox) -> None:
    landlock.restrict(box.readable, box.writable)


def test_without_walls_the_kernel_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(landlock, "abi", lambda: 0)
    monkeypatch.setattr(sandbox.seccomp, "is_known", lambda: False)
    assert sandbox.status() == SandboxStatus(files=False, network=False, processes=False)
    assert sandbox.status().missing == ("other files", "the network", "new processes")


def test_a_child_that_computes_too_long_ends(pool: ChildPool) -> None:
    with pytest.raises(ChildEnded) as end:
        pool.submit(_compute_after_limit).result(NET_S)
    assert end.value.exit_code == -signal.SIGXCPU
    assert not end.value.is_from_outside


def _compute_after_limit() -> None:
    sandbox.CPU_SLACK_S = 0
    limit_cpu(0.0)
    while True:
        pass


def test_a_child_in_compiled_code_dies_with_its_parent(tmp_path: Path) -> None:
    """It holds the lock of the interpreter, so that no thread of Python can end it."""
    context = multiprocessing.get_context("spawn")
    parent = context.Process(target=_start_stuck_child, args=(str(tmp_path / "pid"),))
    parent.start()
    file = tmp_path / "pid"
    child = psutil.Process(int(wait_until(lambda: file.exists() and file.read_text(), NET_S)))
    used = child.cpu_times().user
    wait_until(lambda: child.cpu_times().user > used + 0.3, NET_S)  # it is stuck now
    parent.kill()
    wait_until(lambda: not child.is_running() or child.status() == psutil.STATUS_ZOMBIE, NET_S)


def _start_stuck_child(path: str) -> None:
    ChildPool(1, _nothing).submit(_stick, path).result(NET_S)


def _nothing() -> None:
    pass


def _stick(path: str) -> None:
    whole = Path(f"{path}.part")
    whole.write_text(str(os.getpid()))
    whole.rename(path)
    re.match(r"(a|aa)+$", "a" * 60 + "b")  # takes years, in one call of C


def test_the_sandbox_makes_no_start_slower() -> None:
    """What it needs is loaded in the server of children already, or is in the standard library."""
    context = child_context()
    answers = context.Queue()
    process = context.Process(target=_report_new_modules, args=(answers, LIBRARIES))
    process.start()
    new = answers.get(timeout=NET_S)
    process.join()
    assert [name for name in new if not name.startswith(("app.", "_"))] == []


def _report_new_modules(answers: object, libraries: list[str]) -> None:
    before = set(sys.modules)
    import app.services.children.sandbox  # noqa: F401

    time.sleep(0)
    answers.put(sorted(set(sys.modules) - before - set(libraries)))  # type: ignore[attr-defined]
