"""The quarantine: stored files that the database does not name, kept for a while.

Such files are what a crash left, or a sign that the database is not the newest one. So none is
removed at once: it waits here, under its SHA-256, and goes back when the database names it again.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from app.store.folders import make_private_synced

FOLDER = "quarantine"
NAME_LENGTH = 64
"""Of a SHA-256 in hex."""
DAY_S = 24 * 3600.0
MAX_PURGE_GAP_S = DAY_S
"""Time between two purges counts up to this; so a clock that jumps ahead ends no retention."""
_LAST_PURGE = "last-purge"


@dataclass(frozen=True, slots=True)
class QuarantineContent:
    """What the quarantine holds. oldest: when its first file came, seconds since 1970."""

    names: tuple[str, ...]
    bytes: int
    oldest: float | None


class Quarantine:
    """A folder of files by SHA-256; a file's time of change is when it came here."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file here."""
        for path in self._files():
            yield path.name

    def take(self, path: Path) -> None:
        """Moves a stored file here. Raises OSError."""
        make_private_synced(self.folder)
        # Before the move: with an older time it would be purged at once after a crash.
        os.utime(path)
        path.replace(self.folder / path.name)

    def give_back(self, place: Path) -> bool:
        """Moves a file back to its place in the store; whether there was one. Raises OSError."""
        held = self.folder / place.name
        if place.is_file():
            held.unlink(missing_ok=True)
            return False
        if not held.is_file():
            return False
        make_private_synced(place.parent)
        with suppress(FileNotFoundError):  # another process gave it back
            held.replace(place)
        return place.is_file()

    def remove(self, sha256: str) -> None:
        """Removes a file, if it is here."""
        (self.folder / sha256).unlink(missing_ok=True)

    def purge(self, older_than_s: float) -> tuple[str, ...]:
        """Removes what has been here longer; the names. Call it often: see MAX_PURGE_GAP_S."""
        if not self.folder.is_dir():
            return ()
        now = time.time()
        self._discount_jump(now)
        old = [path for path in self._files() if now - path.stat().st_mtime > older_than_s]
        for path in old:
            path.unlink(missing_ok=True)
        return tuple(path.name for path in old)

    def content(self) -> QuarantineContent:
        """What is here."""
        told = {path.name: path.stat() for path in self._files()}
        oldest = min((each.st_mtime for each in told.values()), default=None)
        return QuarantineContent(
            tuple(sorted(told)), sum(each.st_size for each in told.values()), oldest
        )

    def _discount_jump(self, now: float) -> None:
        """Moves all times along with a clock that was set, or while no purge was made."""
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
