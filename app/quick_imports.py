"""Imports without the garbage collector, for commands that should start at once.

An import makes objects that live until the end of the program. Meanwhile the collector looks
through all of them again and again: 11 % of the CPU time of `kinedex search`.
"""

from __future__ import annotations

import gc
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def without_collector() -> Iterator[None]:
    """Turn the garbage collector off in the block."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
