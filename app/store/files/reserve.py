"""Disk space in reserve, so that clips can be deleted when the disk is full.

To delete rows, SQLite first writes: changed pages go to its log. A file next to the database holds
space for that. It is removed when a deletion finds the disk full.
"""

from __future__ import annotations

import logging
import os
import shutil
from contextlib import suppress
from pathlib import Path

_log = logging.getLogger(__name__)

MIN_BYTES, MAX_BYTES = 2**20, 64 * 2**20
"""Size of the reserve. A deletion does not write more than the size of the database. A clip takes a
few tens of MiB there, unless it is an hour long."""
MIN_FREE_RATIO = 4
"""The reserve is made only if the free space is at least this multiple of its size."""
SHARE_TAKEN_BACK = 0.75
"""Share of the free space that a new reserve takes after a deletion used the old one."""


class Reserve:
    """A file next to a database that reserves disk space.

    It is as large as the database, but at least MIN_BYTES and at most MAX_BYTES.
    """

    def __init__(self, database: Path) -> None:
        self.path = database.with_name(f"{database.name}.reserve")
        self._database = database

    def make(self) -> None:
        """Makes the file, or lets it grow with the database, if enough space is free."""
        with suppress(OSError):
            size = self._target_size()
            is_enough = self.path.exists() and 2 * self.path.stat().st_size > size
            if not is_enough and self._free() >= MIN_FREE_RATIO * size:
                self._allocate(size)

    def take_back(self) -> None:
        """Makes the file again after `give_up`, from most of the free space.

        The program that filled the disk would also fill this space, but the next deletion needs
        it.
        """
        with suppress(OSError):
            size = min(self._target_size(), int(SHARE_TAKEN_BACK * self._free()))
            if size >= MIN_BYTES and not self.path.exists():
                self._allocate(size)

    def give_up(self) -> bool:
        """Removes the file, which frees its space; returns whether there was one."""
        try:
            self.path.unlink()
        except OSError:
            return False
        _log.warning("the disk is full: the space in reserve was given up for a deletion")
        return True

    def _target_size(self) -> int:
        return min(max(self._database.stat().st_size, MIN_BYTES), MAX_BYTES)

    def _free(self) -> int:
        return shutil.disk_usage(self.path.parent).free

    def _allocate(self, size: int) -> None:
        descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
        finally:
            os.close(descriptor)
