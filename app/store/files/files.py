"""The file store: the original bytes of files, each named by its SHA-256.

Bytes are first written to a temporary file and synced. `StagedFile.keep` renames the file to
`<first two hex digits>/<next two>/<all 64>` and syncs the directories. So a file with its final
name is always complete, even after a crash.
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

from app.errors import BadField, DiskFull, NotFound, StorageError, TooLarge
from app.kinedex_error import Place
from app.store.files.hash_check import SHA256, HashChecker
from app.store.files.id_file import read_id
from app.store.files.locked_file import create_locked, remove_if_abandoned
from app.store.files.quarantine import FOLDER, Quarantine
from app.store.files.removal_hold import RemovalHold
from app.store.folders import make_private_synced, sync_folder

CHUNK_BYTES = 1024 * 1024
NO_SPACE = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG})


class Readable(Protocol):
    """A source of bytes: a file, an upload, a member of an archive."""

    def read(self, size: int, /) -> bytes:
        """At most `size` bytes; none at the end."""
        ...


@dataclass(frozen=True, slots=True)
class StagedFile:
    """A synced file with a temporary name, which is not part of the store yet."""

    sha256: str
    size: int
    temporary: Path
    final: Path

    def keep(self) -> None:
        """Makes the file part of the store. The store may already hold the same bytes.

        Call it in the write transaction that adds the row which refers to the file. Raises
        DiskFull, StorageError.
        """
        with _disk_failures():
            make_private_synced(self.final.parent)
            self.temporary.replace(self.final)
            sync_folder(self.final.parent)

    def open(self) -> BinaryIO:
        """The staged bytes, for reading before `keep`."""
        return self.temporary.open("rb")


class FileStore:
    """A directory of files by SHA-256; any number of processes may share it."""

    def __init__(self, root: Path, library_id: str | None = None) -> None:
        """library_id: the library of these files; with None, `check_identity` checks nothing."""
        self.root = root
        self.library_id = library_id
        self.quarantine = Quarantine(root / FOLDER)
        self.removal_hold = RemovalHold(root)
        self.suspects: set[str] = set()
        """Files that somebody found missing or damaged; `FileWatch` takes them and looks again."""
        self._temporaries = root / "tmp"
        self._checked = HashChecker()

    def check_identity(self) -> None:
        """Raises StorageError if the folder does not belong to the library (any more).

        If the disk is not mounted, the folder is empty, and nothing may be stored in it.
        """
        if self.library_id is None:
            return
        with _disk_failures():
            folder_id = read_id(self.root)
        if folder_id != self.library_id:
            raise StorageError(
                f"The folder {self.root} is not the one of this library: its id is "
                f"{folder_id or 'no id'}, and {self.library_id} is expected"
            )

    @contextmanager
    def stage(self, content: Readable, *, max_bytes: int | None = None) -> Iterator[StagedFile]:
        """Streams content to a temporary file, which is removed after the block unless `keep` ran.

        Raises TooLarge if the content has more than `max_bytes`; DiskFull; StorageError. Then
        nothing is left on the disk.
        """
        self.check_identity()
        with _disk_failures():
            make_private_synced(self._temporaries)
            temporary, file = create_locked(self._temporaries, "up")
        try:
            with _disk_failures():
                sha256, size = _write_synced(file, content, max_bytes)
            # The file is open, and so locked, until the end: a sweep does not remove it.
            yield StagedFile(sha256, size, temporary, self._path_of(sha256))
        finally:
            with suppress(OSError):  # a full disk was reported already
                file.close()
            temporary.unlink(missing_ok=True)

    def path(self, sha256: str) -> Path:
        """The path of the file; raises NotFound if the store does not have it.

        A file in the quarantine is moved back, because somebody needs it.
        """
        path = self._path_of(sha256)
        if not path.is_file() and not self.bring_back(sha256):
            self.suspects.add(sha256)
            raise NotFound(f"The file {sha256} is not in the store")
        return path

    def has(self, sha256: str) -> bool:
        """Whether the store or its quarantine has the file."""
        return self._path_of(sha256).is_file() or (self.quarantine.folder / sha256).is_file()

    def open(self, sha256: str) -> BinaryIO:
        """The file, for reading; raises NotFound."""
        return self.path(sha256).open("rb")

    def checked_path(self, sha256: str) -> Path:
        """As `path`, but the file is checked for damage; raises FileDamaged too."""
        path = self.path(sha256)
        try:
            with _disk_failures():
                self._checked.check(path)
        except StorageError:
            self.suspects.add(sha256)
            raise
        return path

    def remove(self, sha256: str) -> None:
        """Removes the file from the store and the quarantine, if it is there.

        `removals` decides whether a file may be removed.
        """
        with _disk_failures():
            self._path_of(sha256).unlink(missing_ok=True)
            self.quarantine.remove(sha256)

    def set_aside(self, sha256: str) -> None:
        """Moves the file to the quarantine, if the store has it."""
        path = self._path_of(sha256)
        if path.is_file():
            with _disk_failures():
                self.quarantine.take(path)

    def bring_back(self, sha256: str) -> bool:
        """Moves the file back from the quarantine; returns whether the store has it by that."""
        with _disk_failures():
            return self.quarantine.give_back(self._path_of(sha256))

    def remove_abandoned_temporaries(self) -> int:
        """Removes the temporary files of dead processes; returns their number."""
        temporaries = [*self._temporaries.glob("up_*"), *self.root.glob("id_*")]
        return sum(remove_if_abandoned(path, Path.unlink) for path in temporaries)

    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file in the store."""
        for path in self.root.glob("[0-9a-f][0-9a-f]/[0-9a-f][0-9a-f]/*"):
            if SHA256.fullmatch(path.name):
                yield path.name

    def _path_of(self, sha256: str) -> Path:
        # A text that is no hash, such as "../..", could lead out of the folder.
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
