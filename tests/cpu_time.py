"""Limits on the CPU time of work. Unlike wall time, it grows little with the machine's load."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager

# A neighbor on the same core can make the same work cost twice the CPU time and more. What the
# limits are for, work that grows with the square of its input, costs a hundred times as much.
NOISE = 5.0


@contextmanager
def cpu_seconds_below(limit: float, what: str = "this") -> Iterator[None]:
    """Fail if the block takes `NOISE` times `limit` seconds or more of this thread's CPU time;
    a quiet machine takes less than `limit`."""
    began = time.thread_time()
    try:
        yield
    finally:  # also where the block ends by an exception that is expected
        spent = time.thread_time() - began
        most = NOISE * limit
        assert spent < most, f"{what} took {spent:.2f} s of CPU time, expected less than {most} s"
