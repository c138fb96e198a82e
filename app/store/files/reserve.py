"""Disk space that is kept in reserve, so that things can be deleted when the disk is full.

To delete rows SQLite first writes: the pages that it overwrites go to its log. A file of some
size beside the database holds that space, and is given up when a deletion meets a full disk.
"""

from __future__ import annotations

import logging
import os
import shutil
from contextlib import suppress
from pathlib import Path

_log = logging.getLogger(__name__)

MIN_BYTES, MAX_BYTES = 2**20, 64 * 2**20
"""Bytes. A deletion writes no more than the database holds; and no clip is larger than a few
tens of MiB there, but for one of an hour."""
ROOM = 4
"""The reserve is made while so many times its size are free."""
SHARE_TAKEN_BACK = 0.75
"""Of what is free after it was given up."""


class Reserve:
    """A file beside a database, as large as that is between MIN_BYTES and MAX_BYTES; or none."""

    def __init__(self, database: Path) -> None:
        self.path = database.with_name(f"{database.name}.reserve")
        self._database = database

    def make(self) -> None:
        """Makes the file, or lets it grow with the database, unless the disk has little room."""
        with suppress(OSError):
            size = self._wanted()
            is_enough = self.path.exists() and 2 * self.path.stat().st_size > size
            if not is_enough and self._free() >= ROOM * size:
                self._allocate(size)

    def take_back(self) -> None:
        """Makes the file again after it was given up, of most of what is free: whoever filled the
        disk would fill that too, and the next deletion needs it."""
        with suppress(OSError):
            size = min(self._wanted(), int(SHARE_TAKEN_BACK * self._free()))
            if size >= MIN_BYTES and not self.path.exists():
                self._allocate(size)

    def give_up(self) -> bool:
        """Removes the file; whether there was one."""
        try:
            self.path.unlink()
        except OSError:
            return False
        _log.warning("the disk is full: the space in reserve was given up for a deletion")
        return True

    def _wanted(self) -> int:
        return min(max(self._database.stat().st_size, MIN_BYTES), MAX_BYTES)

    def _free(self) -> int:
        return shutil.disk_usage(self.path.parent).free

    def _allocate(self, size: int) -> None:
        descriptor = os.open(self.path, os.O_WRONLY | os.O_CREAT, 0o600)
        try:
            os.posix_fallocate(descriptor, 0, size)
        finally:
            os.close(descriptor)
