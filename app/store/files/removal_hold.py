"""A hold on removals: while somebody copies a library, no process removes a file of it.

In a folder, the hold is a shared lock on one file of the folder, so any number of copies may run at
once. Who wants to remove files needs the lock alone, does not wait for it, and tries again later.
The kernel releases the lock when a process ends, even after kill -9. The files of a bucket have
many machines; there the database holds the lock (`database.advisory_hold`).

Where the folder is read only, or its file system has no locks, nobody holds anything: files are
removed at once, and a copy that lacks one says so.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from pathlib import Path
from typing import Protocol

FILE = ".removals"
"""Name of the locked file, which is empty."""


class RemovalHold(Protocol):
    """A hold on the removals of one store of files, which all its users share."""

    def held(self) -> AbstractContextManager[None]:
        """Within the block, no process removes a file. Waits for removals that have begun."""
        ...

    def free(self) -> AbstractContextManager[bool]:
        """Whether files may be removed within the block: no process holds them."""
        ...


class FolderHold:
    """The hold on the removals of one folder of files, which all its users share."""

    def __init__(self, folder: Path) -> None:
        self._path = folder / FILE

    @contextmanager
    def held(self) -> Iterator[None]:
        """Within the block, no process removes a file. Waits for removals that have begun."""
        with self._opened() as descriptor:
            if descriptor is not None:
                with suppress(OSError):
                    fcntl.flock(descriptor, fcntl.LOCK_SH)
            yield

    @contextmanager
    def free(self) -> Iterator[bool]:
        """Whether files may be removed within the block: no process holds them."""
        with self._opened() as descriptor:
            yield descriptor is None or _is_lockable(descriptor)

    @contextmanager
    def _opened(self) -> Iterator[int | None]:
        try:
            descriptor = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError:
            yield None
            return
        try:
            yield descriptor
        finally:
            os.close(descriptor)


def _is_lockable(descriptor: int) -> bool:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:  # the file system has no locks
        return True
    return True
