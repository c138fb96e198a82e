"""Deadlines: work stops between its steps when its time is up or nobody waits for it."""

from __future__ import annotations

import threading
from concurrent.futures import Future, ThreadPoolExecutor
from contextvars import copy_context

import pytest

from app.deadline import Deadline, check, current, result_of, within
from app.errors import ClientLeft, DeadlineExceeded


def test_work_without_a_deadline_never_stops() -> None:
    assert current() is None
    check()


def test_work_stops_when_its_time_is_up() -> None:
    def work() -> None:
        while True:
            check()

    with within(Deadline(0.01)) as deadline, pytest.raises(DeadlineExceeded, match=r"0\.01 s"):
        work()
    assert deadline.remaining() == 0.0


def test_work_stops_when_it_is_abandoned() -> None:
    with within(Deadline(60.0)) as deadline:
        check()
        deadline.abandon()
        with pytest.raises(ClientLeft):
            check()


def test_a_restart_gives_the_whole_time_again() -> None:
    deadline = Deadline(60.0)
    deadline._end = 0.0
    deadline.restart()
    deadline.check()
    assert deadline.remaining() > 50.0


def test_blocks_may_be_nested_and_leave_nothing_behind() -> None:
    outer, inner = Deadline(), Deadline()
    with within(outer):
        with within(inner):
            assert current() is inner
        assert current() is outer
    assert current() is None


def test_a_thread_with_a_copy_of_the_context_has_the_same_deadline() -> None:
    with within(Deadline()) as deadline, ThreadPoolExecutor(1) as pool:
        context = copy_context()
        assert pool.submit(context.run, current).result() is deadline
        assert pool.submit(current).result() is None


def test_a_result_is_waited_for() -> None:
    with within(Deadline(60.0)), ThreadPoolExecutor(1) as pool:
        assert result_of(pool.submit(lambda: 7)) == 7
    with ThreadPoolExecutor(1) as pool:
        assert result_of(pool.submit(lambda: 8)) == 8


def test_a_timeout_inside_the_work_is_the_failure_of_its_result() -> None:
    late: Future[int] = Future()
    late.set_exception(TimeoutError("its own"))
    with within(Deadline(60.0)), pytest.raises(TimeoutError, match="its own"):
        result_of(late)


def test_a_result_that_nobody_waits_for_is_canceled() -> None:
    never: Future[int] = Future()
    with within(Deadline(60.0)) as deadline:
        threading.Timer(0.05, deadline.abandon).start()
        with pytest.raises(ClientLeft):
            result_of(never)
    assert never.cancelled()
