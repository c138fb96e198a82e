"""The quarantine: a place for stored files that the database does not name.

A crash left such files, or the database is an old copy. So they are not removed at once. They stay
here, named by their SHA-256, until the retention is over, and go back if the database names them.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from app.store.folders import make_private_synced

FOLDER = "quarantine"
NAME_LENGTH = 64
"""Characters of a SHA-256 in hex."""
DAY_S = 24 * 3600.0
MAX_PURGE_GAP_S = DAY_S
"""The time between two purges counts only up to this limit. So if the clock jumps ahead, no file is
removed too early."""
_LAST_PURGE = "last-purge"


@dataclass(frozen=True, slots=True)
class QuarantineContent:
    """The files in the quarantine.

    names: their SHA-256, sorted; bytes: their total size; oldest: when the first of them came,
    seconds since 1970, None for an empty quarantine.
    """

    names: tuple[str, ...]
    bytes: int
    oldest: float | None


class Quarantine(Protocol):
    """What a sweep and a verification need of a quarantine."""

    name: str
    """What messages call it."""

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file here."""
        ...

    def purge(self, older_than_s: float) -> tuple[str, ...]:
        """Removes files that have been here for more than `older_than_s` seconds.

        Returns their names. Call it at least every MAX_PURGE_GAP_S, because more time does not
        count. Raises OSError, StorageError.
        """
        ...

    def content(self) -> QuarantineContent:
        """The names, the size and the age of all files here."""
        ...


class FolderQuarantine:
    """A folder of files by SHA-256. The modification time of a file is when it came here."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.name = str(folder)

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file here."""
        for path in self._files():
            yield path.name

    def take(self, path: Path) -> None:
        """Moves a stored file here. Raises OSError."""
        make_private_synced(self.folder)
        # Set before the move: after a crash between both, an older time would be purged at once.
        os.utime(path)
        path.replace(self.folder / path.name)

    def give_back(self, path: Path) -> bool:
        """Moves a file back to `path` in the store; returns whether it did. Raises OSError."""
        quarantined = self.folder / path.name
        if path.is_file():
            quarantined.unlink(missing_ok=True)
            return False
        if not quarantined.is_file():
            return False
        make_private_synced(path.parent)
        with suppress(FileNotFoundError):  # another process moved it back
            quarantined.replace(path)
        return path.is_file()

    def remove(self, sha256: str) -> None:
        """Removes a file, if it is here."""
        (self.folder / sha256).unlink(missing_ok=True)

    def purge(self, older_than_s: float) -> tuple[str, ...]:
        """As `Quarantine.purge`. Raises OSError."""
        if not self.folder.is_dir():
            return ()
        now = time.time()
        self._discount_jump(now)
        old = [path for path in self._files() if now - path.stat().st_mtime > older_than_s]
        for path in old:
            path.unlink(missing_ok=True)
        return tuple(path.name for path in old)

    def content(self) -> QuarantineContent:
        """The names, the size and the age of all files here."""
        stats = {path.name: path.stat() for path in self._files()}
        oldest = min((each.st_mtime for each in stats.values()), default=None)
        return QuarantineContent(
            tuple(sorted(stats)), sum(each.st_size for each in stats.values()), oldest
        )

    def _discount_jump(self, now: float) -> None:
        """Adds to the times of all files the part of the last gap that must not count.

        That is the part beyond MAX_PURGE_GAP_S, or the negative gap of a clock that was set back.
        """
        mark = self.folder / _LAST_PURGE
        last = mark.stat().st_mtime if mark.exists() else now
        jump = (now - last) - min(max(now - last, 0.0), MAX_PURGE_GAP_S)
        if jump:
            for path in self._files():
                moved = path.stat().st_mtime + jump
                os.utime(path, (moved, moved))
        mark.touch(mode=0o600)
        os.utime(mark, (now, now))

    def _files(self) -> list[Path]:
        return [path for path in self.folder.glob("*") if len(path.name) == NAME_LENGTH]
