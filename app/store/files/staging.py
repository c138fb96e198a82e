"""Writes content to a temporary file of this machine, and hashes it on the way."""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from app.errors import DiskFull, StorageError, TooLarge
from app.store.files.files import Readable
from app.store.files.locked_file import create_locked
from app.store.folders import make_private_synced

CHUNK_BYTES = 1024 * 1024
NO_SPACE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})
TEMPORARIES = "tmp"
"""Name of the folder of temporary files in the folder of files."""


@dataclass(frozen=True, slots=True)
class Hashed:
    """What is known of bytes after they were read once. size: their number."""

    sha256: str
    size: int


@contextmanager
def staged_on_disk(
    folder: Path, content: Readable, max_bytes: int | None
) -> Iterator[tuple[Path, Hashed]]:
    """Streams content to a new synced file, which is removed after the block if it is still there.

    It is locked within the block, so a sweep does not remove it. Raises TooLarge, DiskFull,
    StorageError.
    """
    with disk_failures():
        make_private_synced(folder)
        temporary, file = create_locked(folder, "up")
    try:
        with disk_failures():
            hashed = _write_synced(file, content, max_bytes)
        yield temporary, hashed
    finally:
        with suppress(OSError):  # a full disk was reported already
            file.close()
        temporary.unlink(missing_ok=True)


def _write_synced(file: BinaryIO, content: Readable, max_bytes: int | None) -> Hashed:
    digest, size = hashlib.sha256(), 0
    while chunk := content.read(CHUNK_BYTES):
        size += len(chunk)
        if max_bytes is not None and size > max_bytes:
            raise TooLarge(f"The content is larger than the limit of {max_bytes} bytes")
        digest.update(chunk)
        file.write(chunk)
    file.flush()
    os.fsync(file.fileno())
    return Hashed(digest.hexdigest(), size)


@contextmanager
def disk_failures() -> Iterator[None]:
    """Converts failures of the disk to DiskFull and StorageError."""
    try:
        yield
    except OSError as error:
        if error.errno in NO_SPACE:
            raise DiskFull() from error
        raise StorageError(f"The file store failed: {error.strerror}") from error
