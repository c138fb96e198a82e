"""The file store: original bytes, named by their SHA-256, whole or not there at all.

Bytes go to a temporary name and are synced there; `keep` renames them to
`<first two hex digits>/<next two>/<all 64>` and syncs the directories, so that a file with
its final name is complete whatever happens.
"""

from __future__ import annotations

import errno
import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from app.errors import BadField, DiskFull, NotFound, Place, StorageError, TooLarge
from app.store.files.hash_check import SHA256, HashChecker
from app.store.files.id_file import read_id
from app.store.files.locked_file import create_locked, remove_if_abandoned
from app.store.files.quarantine import FOLDER, Quarantine
from app.store.folders import make_private_synced, sync_folder

CHUNK_BYTES = 1024 * 1024
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
            make_private_synced(self.final.parent)
            self.temporary.replace(self.final)
            sync_folder(self.final.parent)

    def open(self) -> BinaryIO:
        """The staged bytes, to look at before they are kept."""
        return self.temporary.open("rb")


class FileStore:
    """A directory of files by SHA-256; any number of processes may share it."""

    def __init__(self, root: Path, library_id: str | None = None) -> None:
        """library_id: of the library whose files these are; None does not ask."""
        self.root = root
        self.library_id = library_id
        self.quarantine = Quarantine(root / FOLDER)
        self._temporaries = root / "tmp"
        self._checked = HashChecker()

    def check_identity(self) -> None:
        """Raises StorageError where the folder is not, or no more, that of the library.

        A disk that is not mounted leaves an empty folder: nothing may be stored there.
        """
        if self.library_id is None:
            return
        with _disk_failures():
            found = read_id(self.root)
        if found != self.library_id:
            raise StorageError(
                f"The folder {self.root} is not the one of this library: it holds "
                f"{found or 'no id'}, and {self.library_id} is expected"
            )

    @contextmanager
    def stage(self, content: Readable, *, max_bytes: int | None = None) -> Iterator[StagedFile]:
        """Streams content to disk; what is not kept in the block is removed after it.

        Raises TooLarge beyond `max_bytes` and DiskFull; then nothing is left.
        """
        self.check_identity()
        with _disk_failures():
            make_private_synced(self._temporaries)
            temporary, file = create_locked(self._temporaries, "up")
        try:
            with _disk_failures():
                sha256, size = _write_synced(file, content, max_bytes)
            # Open, and so locked, to the end: a sweep lets it be.
            yield StagedFile(sha256, size, temporary, self._place(sha256))
        finally:
            with suppress(OSError):  # a full disk has been told already
                file.close()
            temporary.unlink(missing_ok=True)

    def path(self, sha256: str) -> Path:
        """Where the file is; raises NotFound when the store does not have it.

        One that went to the quarantine by mistake is brought back.
        """
        place = self._place(sha256)
        if not place.is_file() and not self.bring_back(sha256):
            raise NotFound(f"The file {sha256} is not in the store")
        return place

    def has(self, sha256: str) -> bool:
        """Whether the store has the file, the quarantine included."""
        return self._place(sha256).is_file() or (self.quarantine.folder / sha256).is_file()

    def open(self, sha256: str) -> BinaryIO:
        """The file, for reading; raises NotFound."""
        return self.path(sha256).open("rb")

    def checked_path(self, sha256: str) -> Path:
        """As `path`, of a file whose bytes are those that were stored; raises FileDamaged too."""
        path = self.path(sha256)
        with _disk_failures():
            self._checked.check(path)
        return path

    def remove(self, sha256: str) -> None:
        """Removes the file, if there, also from the quarantine; `removals` knows whether it may."""
        with _disk_failures():
            self._place(sha256).unlink(missing_ok=True)
            self.quarantine.remove(sha256)

    def set_aside(self, sha256: str) -> None:
        """Moves the file, if there, to the quarantine."""
        place = self._place(sha256)
        if place.is_file():
            with _disk_failures():
                self.quarantine.take(place)

    def bring_back(self, sha256: str) -> bool:
        """Moves the file back from the quarantine; whether it was there and is missing no more."""
        with _disk_failures():
            return self.quarantine.give_back(self._place(sha256))

    def remove_abandoned_temporaries(self) -> int:
        """Removes what uploads left whose process died; returns how many."""
        left = [*self._temporaries.glob("up_*"), *self.root.glob("id_*")]
        return sum(remove_if_abandoned(path, Path.unlink) for path in left)

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


def _write_synced(file: BinaryIO, content: Readable, max_bytes: int | None) -> tuple[str, int]:
    digest, size = hashlib.sha256(), 0
    while chunk := content.read(CHUNK_BYTES):
        size += len(chunk)
        if max_bytes is not None and size > max_bytes:
            raise TooLarge(f"The content is larger than the limit of {max_bytes} bytes")
        digest.update(chunk)
        file.write(chunk)
    file.flush()
    os.fsync(file.fileno())
    return digest.hexdigest(), size


@contextmanager
def _disk_failures() -> Iterator[None]:
    try:
        yield
    except OSError as error:
        if error.errno in NO_SPACE:
            raise DiskFull() from error
        raise StorageError(f"The file store failed: {error.strerror}") from error
