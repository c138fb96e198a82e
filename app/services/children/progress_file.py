"""The progress of a task in a child process, as a small file that the child writes.

The pipe of a child (`child.Child`) is for the task and its result only. A file needs no thread in
the parent and no second pipe, and a child that is killed leaves the last progress behind.
"""

from __future__ import annotations

import os
import struct
import tempfile
from collections.abc import Callable

_COUNTS = struct.Struct("<QQ")
"""The number of steps done, and of all steps."""

Progress = Callable[[int, int], None]
"""Called with the number of steps done and the total."""


class ProgressFile:
    """The file as the parent has it. It is removed when it is closed."""

    def __init__(self) -> None:
        # It stays open, so no context manager.
        self._file = tempfile.NamedTemporaryFile(prefix="kinedex-progress-")  # noqa: SIM115
        self.path = self._file.name

    def read(self) -> tuple[int, int]:
        """The number of steps done and the total; (0, 0) before the first step."""
        written = os.pread(self._file.fileno(), _COUNTS.size, 0)
        if len(written) < _COUNTS.size:
            return 0, 0
        done, total = _COUNTS.unpack(written)
        return done, total

    def close(self) -> None:
        """Remove the file."""
        self._file.close()


def progress_to(path: str) -> Progress:
    """A function for the child that writes the progress into the file."""
    # A child that outlives the file must not make it again: so no "w".
    file = os.open(path, os.O_WRONLY)

    def write(done: int, total: int) -> None:
        os.pwrite(file, _COUNTS.pack(done, total), 0)

    return write
