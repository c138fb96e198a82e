"""A child that is killed, stopped, canceled or late fails its own task, and no other one."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError, Future, wait
from pathlib import Path
from typing import Any

import psutil
import pytest

from app.services.children.child import ChildEnded
from app.services.children.pool import ChildPool, TaskTimedOut
from tests.live import wait_until

NET_S = 240.0
"""Time limit of every wait: much more than any test needs."""


def _nothing() -> None:
    """The preparation of the children: they need none."""


@pytest.fixture
def pool() -> Iterator[ChildPool]:
    opened = ChildPool(2, _nothing)
    yield opened
    opened.close()


def _pid_then(path: str, seconds: float) -> str:
    Path(path).write_text(str(os.getpid()))
    time.sleep(seconds)
    return "done"


def _raise(signal_number: int) -> None:
    os.kill(os.getpid(), signal_number)
    time.sleep(NET_S)


def _unsendable() -> None:
    raise ValueError(threading.Lock())


def _leave(code: int) -> None:
    os._exit(code)


def _large(path: str, size: int) -> bytes:
    Path(path).write_text(str(os.getpid()))
    return bytes(size)


def _between(first: str, second: str) -> bool:
    """Whether another task runs during this one. Each task creates a file when it runs."""
    Path(first).touch()
    end = time.monotonic() + 1.0
    while time.monotonic() < end:
        if Path(second).exists():
            return True
        time.sleep(0.01)
    return False


def _pid_in(path: Path) -> int:
    return int(wait_until(lambda: path.exists() and path.read_text(), NET_S))


def _server() -> psutil.Process:
    return next(
        child
        for child in psutil.Process().children()
        if "multiprocessing.forkserver" in " ".join(child.cmdline())
    )


def test_the_future_gets_the_result_or_the_failure(pool: ChildPool) -> None:
    assert pool.submit(sum, [1, 2]).result(NET_S) == 3
    with pytest.raises(ZeroDivisionError) as failure:
        pool.submit(divmod, 1, 0).result(NET_S)
    assert "Traceback" in failure.value.__notes__[0]
    with pytest.raises(RuntimeError, match="Traceback"):
        pool.submit(_unsendable).result(NET_S)


@pytest.mark.parametrize(
    ("work", "argument", "is_from_outside"),
    [
        (_raise, signal.SIGKILL, True),
        (_raise, signal.SIGTERM, True),
        (_raise, signal.SIGSEGV, False),
        (_raise, signal.SIGBUS, False),
        (_raise, signal.SIGABRT, False),
        (_leave, 3, False),
    ],
)
def test_the_end_of_a_child_says_whether_its_task_was_the_cause(
    pool: ChildPool, work: Callable[[int], None], argument: int, is_from_outside: bool
) -> None:
    with pytest.raises(ChildEnded) as end:
        pool.submit(work, argument).result(NET_S)
    assert end.value.is_from_outside is is_from_outside
    assert pool.submit(sum, [1]).result(NET_S) == 1


def test_if_memory_is_short_a_kill_counts_as_caused_by_the_task() -> None:
    assert ChildEnded(-signal.SIGKILL).is_from_outside
    assert not ChildEnded(-signal.SIGKILL, memory_was_short=True).is_from_outside


@pytest.mark.parametrize("jump", [3600.0, -3600.0])
def test_a_jump_of_the_wall_clock_does_not_end_a_task(
    pool: ChildPool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, jump: float
) -> None:
    task = pool.submit(_pid_then, str(tmp_path / "a"), 1.0, seconds=NET_S)
    _pid_in(tmp_path / "a")
    real = time.time
    monkeypatch.setattr(time, "time", lambda: real() + jump)
    assert task.result(NET_S) == "done"


def test_a_late_task_and_a_stopped_child_are_killed(pool: ChildPool, tmp_path: Path) -> None:
    late = pool.submit(_pid_then, str(tmp_path / "late"), NET_S, seconds=2.0)
    with pytest.raises(TaskTimedOut):
        late.result(NET_S)
    stopped = pool.submit(_pid_then, str(tmp_path / "stopped"), 0.1, seconds=2.0)
    os.kill(_pid_in(tmp_path / "stopped"), signal.SIGSTOP)
    with pytest.raises(TaskTimedOut):
        stopped.result(NET_S)
    for name in ("late", "stopped"):
        assert not psutil.pid_exists(_pid_in(tmp_path / name))


def test_canceling_kills_the_child_and_the_next_task_runs(tmp_path: Path) -> None:
    single = ChildPool(1, _nothing)
    running = single.submit(_pid_then, str(tmp_path / "a"), NET_S)
    pid = _pid_in(tmp_path / "a")
    assert running.cancel()
    assert wait([running], NET_S).done
    with pytest.raises(CancelledError):
        running.result()
    assert single.submit(sum, [1]).result(NET_S) == 1
    assert not psutil.pid_exists(pid)
    single.close()


def test_a_killed_server_is_replaced_and_its_tasks_go_on(pool: ChildPool, tmp_path: Path) -> None:
    running = pool.submit(_pid_then, str(tmp_path / "a"), 2.0)
    child = _pid_in(tmp_path / "a")
    server = _server()
    server.kill()
    # The second task needs a second child, and therefore a new server.
    assert pool.submit(sum, [1]).result(NET_S) == 1
    assert _server().pid != server.pid
    assert running.result(NET_S) == "done"
    # A child whose server is gone can still be killed.
    again = [pool.submit(_pid_then, str(tmp_path / f"b{n}"), NET_S) for n in range(2)]
    pids = [_pid_in(tmp_path / f"b{n}") for n in range(2)]
    assert child in pids
    for task in again:
        task.cancel()
    wait_until(lambda: not any(psutil.pid_exists(pid) for pid in pids), NET_S)


def test_tasks_run_after_the_server_was_killed_several_times(pool: ChildPool) -> None:
    for number in range(2):
        assert pool.submit(sum, [number]).result(NET_S) == number
        for child in _server().children():
            child.kill()
        _server().kill()
    assert pool.submit(sum, [7]).result(NET_S) == 7


@pytest.mark.parametrize("after", [0.0, 0.02, 0.1])
def test_a_child_killed_while_it_sends_its_result_does_not_stop_others(
    pool: ChildPool, tmp_path: Path, after: float
) -> None:
    sending: Future[Any] = pool.submit(_large, str(tmp_path / "a"), 200 * 2**20)
    others = [pool.submit(sum, [number]) for number in range(20)]
    pid = _pid_in(tmp_path / "a")
    time.sleep(after)
    os.kill(pid, signal.SIGKILL)
    assert [other.result(NET_S) for other in others] == list(range(20))
    failure = sending.exception(NET_S)
    assert failure is None or isinstance(failure, ChildEnded)


def test_no_other_task_runs_during_a_task_that_must_be_alone(
    pool: ChildPool, tmp_path: Path
) -> None:
    before, alone, after = (str(tmp_path / name) for name in ("before", "alone", "after"))
    first = pool.submit(_between, before, alone)
    quiet = pool.submit(_between, alone, after, is_alone=True)
    last = pool.submit(_between, after, str(tmp_path / "none"))
    assert not first.result(NET_S)
    assert not quiet.result(NET_S)
    last.result(NET_S)


def test_a_closed_pool_leaves_no_child_and_no_waiting_task(tmp_path: Path) -> None:
    single = ChildPool(1, _nothing)
    running = single.submit(_pid_then, str(tmp_path / "a"), NET_S)
    waiting = single.submit(sum, [1])
    pid = _pid_in(tmp_path / "a")
    threading.Thread(target=single.close).start()
    with pytest.raises(ChildEnded):
        running.result(NET_S)
    assert waiting.cancelled()
    wait_until(lambda: not psutil.pid_exists(pid), NET_S)
