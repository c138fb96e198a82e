"""Copies of a bucket's files on this machine, for whoever needs a path or reads a file often.

The copies are limited in size; the ones that were used least lately go first. A copy is complete
and had the right hash when it got its name.
"""

from __future__ import annotations

import os
import time
from collections.abc import Collection
from contextlib import suppress
from pathlib import Path

from app.store.files.hash_check import SHA256
from app.store.folders import make_private_synced

FOLDER = "copies"
KEPT_S = 120.0
"""A copy that was used within this time stays, so that who got its path can open it."""


class Copies:
    """A folder of copies, which the processes of one machine share."""

    def __init__(self, folder: Path, max_bytes: int) -> None:
        self._folder = folder
        self._max_bytes = max_bytes

    def find(self, sha256: str) -> Path | None:
        """The copy of a file, marked as used now; None if there is none."""
        path = self._folder / sha256
        try:
            os.utime(path)
        except OSError:
            return None
        return path

    def take(self, sha256: str, temporary: Path) -> Path:
        """Makes a finished temporary file a copy, and makes space. Raises OSError."""
        make_private_synced(self._folder)
        path = self._folder / sha256
        temporary.replace(path)
        self._make_space()
        return path

    def remove(self, sha256: str) -> None:
        """Removes a copy, if there is one."""
        with suppress(OSError):
            (self._folder / sha256).unlink(missing_ok=True)

    def keep_only(self, names: Collection[str]) -> None:
        """Removes the copies of files that the store does not have any more."""
        for path, _, used in self._stats():
            if path.name not in names and time.time() - used > KEPT_S:
                self.remove(path.name)

    def _make_space(self) -> None:
        stats = sorted(self._stats(), key=lambda each: each[2])
        excess = sum(size for _, size, _ in stats) - self._max_bytes
        for path, size, used in stats:
            if excess <= 0 or 0 <= time.time() - used < KEPT_S:
                return
            self.remove(path.name)
            excess -= size

    def _stats(self) -> list[tuple[Path, int, float]]:
        """Path, size and time of the last use of each copy."""
        found = []
        for path in self._folder.glob("*"):
            if SHA256.fullmatch(path.name):
                with suppress(OSError):
                    stat = path.stat()
                    found.append((path, stat.st_size, stat.st_mtime))
        return found
