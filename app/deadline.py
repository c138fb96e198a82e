"""How long the work at hand may go on, and whether anyone still waits for its result.

A thread cannot be stopped from outside. So whoever starts work for a request sets a deadline
in the context (`within`), and every long loop calls `check` between its steps, at least once
a second. Without a deadline (the worker, the commands) `check` does nothing.
Standard library only.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from app.errors import ClientLeft, DeadlineExceeded

LOOK_SECONDS = 0.1
"""Between two checks while a result is waited for."""

_Result = TypeVar("_Result")


class Deadline:
    """A time limit that starts now, for work that may also be abandoned before.

    One thread may work while another one abandons or restarts it.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + seconds
        self._is_abandoned = False

    def remaining(self) -> float:
        """Seconds that are left; never below 0."""
        return max(self._end - time.monotonic(), 0.0)

    def restart(self) -> None:
        """Count all of the time again from now: there was progress."""
        self._end = time.monotonic() + self.seconds

    def abandon(self) -> None:
        """Nobody waits any more: the next check stops the work."""
        self._is_abandoned = True

    def check(self) -> None:
        """Raises ClientLeft where the work was abandoned, DeadlineExceeded where time is up."""
        if self._is_abandoned:
            raise ClientLeft
        if time.monotonic() > self._end:
            raise DeadlineExceeded(
                f"The call took longer than its limit of {self.seconds:g} s and was stopped."
            )


_current: ContextVar[Deadline | None] = ContextVar("deadline", default=None)


@contextmanager
def within(deadline: Deadline) -> Iterator[Deadline]:
    """Set the deadline of all work in the block, and in threads that get a copy of its context."""
    mark = _current.set(deadline)
    try:
        yield deadline
    finally:
        _current.reset(mark)


def current() -> Deadline | None:
    """The deadline of the work at hand, if it has one."""
    return _current.get()


def check() -> None:
    """Stop the work at hand where it should not go on.

    Raises ClientLeft, DeadlineExceeded.
    """
    deadline = _current.get()
    if deadline is not None:
        deadline.check()


def result_of(future: Future[_Result]) -> _Result:
    """`future.result()`; where the work at hand should not go on, the future is cancelled.

    Raises what the future raises, ClientLeft, DeadlineExceeded.
    """
    if _current.get() is None:
        return future.result()
    try:
        while True:
            check()
            try:
                return future.result(LOOK_SECONDS)
            except TimeoutError:
                # The future's own failure may be a TimeoutError too.
                if future.done():
                    return future.result()
    except (ClientLeft, DeadlineExceeded):
        future.cancel()
        raise
