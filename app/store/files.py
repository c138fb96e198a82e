"""The file store: original bytes, named by their SHA-256, whole or not there at all.

Bytes go to a temporary name and are synced there; `keep` renames them to
`<first two hex digits>/<next two>/<all 64>` and syncs the directories, so that a file with
its final name is complete whatever happens.
"""

from __future__ import annotations

import errno
import hashlib
import os
import re
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from app.errors import BadField, DiskFull, NotFound, Place, StorageError, TooLarge
from app.store.ids import new_id

CHUNK_BYTES = 1024 * 1024
STALE_AFTER_S = 24 * 3600.0
SHA256 = re.compile(r"[0-9a-f]{64}")
NO_SPACE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})


class Readable(Protocol):
    """Anything that gives bytes: a file, an upload, a member of an archive."""

    def read(self, size: int, /) -> bytes:
        """At most `size` bytes; none at the end."""
        ...


@dataclass(frozen=True, slots=True)
class StagedFile:
    """Bytes that are synced under a temporary name, not yet part of the store."""

    sha256: str
    size: int
    temporary: Path
    final: Path

    def keep(self) -> None:
        """Makes the file part of the store; harmless when the same bytes are there already.

        Call it in the write transaction that adds the row which refers to it.
        """
        with _disk_failures():
            _make_synced(self.final.parent)
            self.temporary.replace(self.final)
            sync_directory(self.final.parent)

    def open(self) -> BinaryIO:
        """The staged bytes, to look at before they are kept."""
        return self.temporary.open("rb")


class FileStore:
    """A directory of files by SHA-256; any number of processes may share it."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._temporaries = root / "tmp"

    @contextmanager
    def stage(self, content: Readable, *, max_bytes: int | None = None) -> Iterator[StagedFile]:
        """Streams content to disk; what is not kept in the block is removed after it.

        Raises TooLarge beyond `max_bytes` and DiskFull; then nothing is left.
        """
        with _disk_failures():
            _make_synced(self._temporaries)
        temporary = self._temporaries / new_id("up")
        try:
            with _disk_failures():
                sha256, size = _write_synced(temporary, content, max_bytes)
            yield StagedFile(sha256, size, temporary, self._place(sha256))
        finally:
            temporary.unlink(missing_ok=True)

    def path(self, sha256: str) -> Path:
        """Where the file is; raises NotFound when the store does not have it."""
        place = self._place(sha256)
        if not place.is_file():
            raise NotFound(f"The file {sha256} is not in the store")
        return place

    def open(self, sha256: str) -> BinaryIO:
        """The file, for reading; raises NotFound."""
        return self.path(sha256).open("rb")

    def remove(self, sha256: str) -> None:
        """Removes the file, if there; `Store.drop_unreferenced` knows whether it may."""
        self._place(sha256).unlink(missing_ok=True)

    def remove_stale_temporaries(self, older_than_s: float = STALE_AFTER_S) -> int:
        """Removes what uploads left that were cut off by a crash; returns how many."""
        removed = 0
        for path in self._temporaries.glob("up_*"):
            with suppress(FileNotFoundError):
                if time.time() - path.stat().st_mtime >= older_than_s:
                    path.unlink()
                    removed += 1
        return removed

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file in the store."""
        for path in self.root.glob("[0-9a-f][0-9a-f]/[0-9a-f][0-9a-f]/*"):
            if SHA256.fullmatch(path.name):
                yield path.name

    def _place(self, sha256: str) -> Path:
        # Guards paths against anything that is not a hash, such as "../..".
        if not SHA256.fullmatch(sha256):
            raise BadField(places=[Place("sha256", "64 lower-case hex digits are expected")])
        return self.root / sha256[:2] / sha256[2:4] / sha256


def _write_synced(path: Path, content: Readable, max_bytes: int | None) -> tuple[str, int]:
    digest, size = hashlib.sha256(), 0
    with path.open("xb") as file:
        while chunk := content.read(CHUNK_BYTES):
            size += len(chunk)
            if max_bytes is not None and size > max_bytes:
                raise TooLarge(f"The content is larger than the limit of {max_bytes} bytes")
            digest.update(chunk)
            file.write(chunk)
        file.flush()
        os.fsync(file.fileno())
    return digest.hexdigest(), size


def _make_synced(directory: Path) -> None:
    """Makes a directory with its parents, each synced into the one above it."""
    if directory.is_dir():
        return
    _make_synced(directory.parent)
    directory.mkdir(exist_ok=True)
    sync_directory(directory.parent)


def sync_directory(directory: Path) -> None:
    """Sees to it that what a directory holds by which name is on disk."""
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


@contextmanager
def _disk_failures() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno in NO_SPACE:
            raise DiskFull() from error
        raise StorageError(f"The file store failed: {error.strerror}") from error
