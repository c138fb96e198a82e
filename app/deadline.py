"""A time limit for the current work, which also stops when nobody waits for its result.

A thread cannot be stopped from outside. So the code that starts work for a request sets a
deadline in the context (`within`), and every long loop calls `check` between its steps, at least
once a second. Without a deadline (in the worker, in the commands) `check` does nothing.
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

CHECK_INTERVAL_S = 0.1
"""Time between two checks while a thread waits for a result."""

_Result = TypeVar("_Result")


class Deadline:
    """A time limit that starts now. The work may also be abandoned before its end.

    One thread may work while another thread calls `abandon` or `restart`.
    """

    def __init__(self, seconds: float = math.inf) -> None:
        self.seconds = seconds
        self._end = time.monotonic() + seconds
        self._is_abandoned = False

    def remaining(self) -> float:
        """Seconds until the limit; never below 0."""
        return max(self._end - time.monotonic(), 0.0)

    def restart(self) -> None:
        """Start the whole time limit again from now, because there was progress."""
        self._end = time.monotonic() + self.seconds

    def abandon(self) -> None:
        """Make the next check stop the work, because nobody waits for it any more."""
        self._is_abandoned = True

    def check(self) -> None:
        """Raises ClientLeft if the work was abandoned, DeadlineExceeded if the time is up."""
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
    """The deadline of the current work, if it has one."""
    return _current.get()


def check() -> None:
    """Stop the current work if it should not go on.

    Raises ClientLeft, DeadlineExceeded.
    """
    deadline = _current.get()
    if deadline is not None:
        deadline.check()


def result_of(future: Future[_Result]) -> _Result:
    """`future.result()`, with a check of the deadline every CHECK_INTERVAL_S.

    If the current work should not go on, the future is canceled. Raises ClientLeft,
    DeadlineExceeded, and every exception of the future.
    """
    if _current.get() is None:
        return future.result()
    try:
        while True:
            check()
            try:
                return future.result(CHECK_INTERVAL_S)
            except TimeoutError:
                # The exception of a finished future may be a TimeoutError too.
                if future.done():
                    return future.result()
    except (ClientLeft, DeadlineExceeded):
        future.cancel()
        raise
