"""Temporary files and folders that are locked while the process that made them lives.

The kernel releases the lock when the process ends, even after kill -9. So a process that can lock
such a file knows that its maker is dead. No clock is needed for that.
"""

from __future__ import annotations

import fcntl
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO

from app.store.database.ids import new_id


def create_locked(folder: Path, noun: str) -> tuple[Path, BinaryIO]:
    """A new private file with a random name, open for writing, and locked until it is closed.

    Raises OSError.
    """
    while True:
        path = folder / new_id(noun)
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        _lock(descriptor)
        if _is_same_file(path, descriptor):
            return path, os.fdopen(descriptor, "wb")
        os.close(descriptor)  # a sweep removed it before it was locked


@contextmanager
def locked_folder(make: Callable[[], Path]) -> Iterator[Path]:
    """The folder that `make` makes, locked within the block. Raises OSError."""
    while True:
        folder = make()
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            _lock(descriptor)
            if _is_same_file(folder, descriptor):
                yield folder
                return
        finally:
            os.close(descriptor)


def remove_if_abandoned(path: Path, remove: Callable[[Path], object]) -> bool:
    """Removes a file or folder that no process has locked; returns whether it was removed.

    Raises OSError of `remove`.
    """
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    except OSError:
        return False  # it does not exist any more, or belongs to another user
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # its maker lives, or the file system has no locks
        # Removed while it is locked: a maker that has not locked it yet then sees that it is gone.
        remove(path)
        return True
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> None:
    # On a file system without locks nobody can lock, so no file counts as abandoned.
    with suppress(OSError):
        fcntl.flock(descriptor, fcntl.LOCK_EX)


def _is_same_file(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False
