"""One process at a time uses the folder of compiled code.

numba keeps what it compiles for librosa in NUMBA_CACHE_DIR. If two processes compile the same
function there at the same time, the folder can hold code that crashes every process that loads it
(seen with numba 0.63 and functions of `guvectorize`: signal 11 in librosa's beat tracker). So a
recording is analyzed while no other one is, among all processes of a library.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

LOCK = "lock"
"""The locked file in the folder. The lock of a process that is killed ends with it."""


@contextmanager
def compiled_code() -> Iterator[None]:
    """Wait until no other process is in this block; without NUMBA_CACHE_DIR, do not wait."""
    folder = os.environ.get("NUMBA_CACHE_DIR")
    if not folder:
        yield
        return
    try:
        lock = (Path(folder) / LOCK).open("ab")
    except OSError:  # then nothing can be kept there either
        yield
        return
    with lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield
