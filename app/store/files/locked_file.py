"""Files and folders that are locked while their maker lives.

The kernel releases the lock when the process ends, however it ends. Whoever can lock a leftover
therefore knows that its maker is dead; no clock is asked.
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
    """A new file with a random name, private, open for writing and locked until it is closed.

    Raises OSError.
    """
    while True:
        path = folder / new_id(noun)
        descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
        _lock(descriptor)
        if _is_still(path, descriptor):
            return path, os.fdopen(descriptor, "wb")
        os.close(descriptor)  # it was taken for a leftover before it was locked


@contextmanager
def locked_folder(make: Callable[[], Path]) -> Iterator[Path]:
    """The folder that `make` makes, locked within the block. Raises OSError."""
    while True:
        folder = make()
        descriptor = os.open(folder, os.O_RDONLY)
        try:
            _lock(descriptor)
            if _is_still(folder, descriptor):
                yield folder
                return
        finally:
            os.close(descriptor)


def remove_if_abandoned(path: Path, remove: Callable[[Path], object]) -> bool:
    """Removes what no living process has locked; whether it did. Raises OSError of `remove`."""
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW)
    except OSError:
        return False  # it is gone, or not ours to open
    try:
        try:
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            return False  # its maker lives, or the disk knows no locks
        # Removed while it is locked, so that a maker who comes to lock it sees that it is gone.
        remove(path)
        return True
    finally:
        os.close(descriptor)


def _lock(descriptor: int) -> None:
    # A disk without locks: nobody can lock there, so nothing is taken for abandoned.
    with suppress(OSError):
        fcntl.flock(descriptor, fcntl.LOCK_EX)


def _is_still(path: Path, descriptor: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(descriptor))
    except FileNotFoundError:
        return False
