"""Checks stored files for damage.

The name of a stored file is the SHA-256 of its bytes, so a new hash finds damage. To hash a large
file takes a second. A player reads a recording in many requests; so a result stays valid for a
while, and only the first request waits.
"""

from __future__ import annotations

import hashlib
import re
import threading
import time
from pathlib import Path
from typing import BinaryIO

from app.errors import FileDamaged
from app.kinedex_error import Place

SHA256 = re.compile(r"[0-9a-f]{64}")
"""The name of a stored file."""
VALID_S = 600.0
"""After this time a file is hashed again: a failing disk damages files that nobody writes."""
MAX_REMEMBERED_FILES = 1024

_State = tuple[int, int, int, int]
"""Device, inode, time of change (ns) and size of a file."""


class HashChecker:
    """Checks files, and remembers those without damage while their state does not change."""

    def __init__(self) -> None:
        self._checked_at: dict[_State, float] = {}
        self._lock = threading.Lock()

    def check(self, path: Path) -> None:
        """Raises FileDamaged if the bytes of the file do not have the hash that is its name.

        Raises OSError too.
        """
        now = time.monotonic()
        state = _state_of(path)
        if now - self._checked_at.get(state, -VALID_S) < VALID_S:
            return
        with path.open("rb") as file:
            refuse_damage(path.name, hashlib.file_digest(file, "sha256").hexdigest())
        with self._lock:
            if len(self._checked_at) >= MAX_REMEMBERED_FILES:
                self._checked_at.clear()
            self._checked_at[state] = now


def read_whole(file: BinaryIO, name: str) -> bytes:
    """The bytes of a file; those of a stored file are checked. Raises FileDamaged, OSError."""
    content = file.read()
    if SHA256.fullmatch(name):
        refuse_damage(name, hashlib.sha256(content).hexdigest())
    return content


def refuse_damage(name: str, actual: str) -> None:
    """Raises FileDamaged unless the name of a stored file is the hash `actual` of its bytes."""
    if name != actual:
        raise FileDamaged(
            f"The stored file {name} is damaged: restore it from a backup.",
            places=[Place(name, f"its bytes have the SHA-256 {actual}")],
        )


def _state_of(path: Path) -> _State:
    stat = path.stat()
    return stat.st_dev, stat.st_ino, stat.st_mtime_ns, stat.st_size
