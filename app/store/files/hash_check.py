"""Stored files whose bytes were seen to be those that were stored.

A file's name is the SHA-256 of its bytes, so that damage is found by hashing. Hashing a large
file takes a second; who asks for it part by part (a player does) waits for that once.
"""

from __future__ import annotations

import hashlib
import re
import threading
import time
from pathlib import Path

from app.errors import FileDamaged, Place

SHA256 = re.compile(r"[0-9a-f]{64}")
"""The name of a stored file."""
VALID_S = 600.0
"""After this a file is hashed again: a disk can go bad under a file that nobody touches."""
MAX_REMEMBERED_FILES = 1024
"""Files that are remembered."""

_State = tuple[int, int, int, int]


class HashChecker:
    """Remembers which files were whole, as long as nothing about them changes."""

    def __init__(self) -> None:
        self._seen: dict[_State, float] = {}
        self._lock = threading.Lock()

    def check(self, path: Path) -> None:
        """Raises FileDamaged unless the file's bytes are those of its name; OSError."""
        now = time.monotonic()
        state = _state_of(path)
        if now - self._seen.get(state, -VALID_S) < VALID_S:
            return
        with path.open("rb") as file:
            refuse_damage(path.name, hashlib.file_digest(file, "sha256").hexdigest())
        with self._lock:
            if len(self._seen) >= MAX_REMEMBERED_FILES:
                self._seen.clear()
            self._seen[state] = now


def read_whole(path: Path) -> bytes:
    """The bytes of a file, of a stored one whole ones. Raises FileDamaged, OSError."""
    content = path.read_bytes()
    if SHA256.fullmatch(path.name):
        refuse_damage(path.name, hashlib.sha256(content).hexdigest())
    return content


def refuse_damage(name: str, found: str) -> None:
    """Raises FileDamaged unless both hashes are the same."""
    if name != found:
        raise FileDamaged(
            f"The stored file {name} is damaged: restore it from a backup.",
            places=[Place(name, f"its bytes have the SHA-256 {found}")],
        )


def _state_of(path: Path) -> _State:
    told = path.stat()
    return told.st_dev, told.st_ino, told.st_mtime_ns, told.st_size
