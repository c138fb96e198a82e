"""Limits on the CPU time of work. Unlike wall time, it does not grow with the machine's load."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def cpu_seconds_below(limit: float, what: str = "this") -> Iterator[None]:
    """Fail if the block takes `limit` seconds or more of this thread's CPU time."""
    began = time.thread_time()
    try:
        yield
    finally:  # also where the block ends by an exception that is expected
        spent = time.thread_time() - began
        assert spent < limit, f"{what} took {spent:.2f} s of CPU time, expected less than {limit} s"
