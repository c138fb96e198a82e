"""Limits on work in CPU time, which does not grow with the machine's load as wall time does."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def cpu_seconds_below(limit: float, what: str = "this") -> Iterator[None]:
    """Fail where the block takes `limit` seconds of this thread's CPU time or more."""
    began = time.thread_time()
    try:
        yield
    finally:  # also where the block ends by an exception that is expected
        spent = time.thread_time() - began
        assert spent < limit, f"{what} took {spent:.2f} s of CPU time, expected less than {limit} s"
