"""Files in a bucket of an S3-compatible store, which any number of machines may share.

The names are those of a folder (`local_files`), so a copy of the bucket is a folder of files. An
upload is staged on the disk of this machine, sent to a temporary name, and read back: only if its
hash is right does `keep` give it its final name, by a copy within the bucket. So a file with its
final name is complete, and an upload that somebody acknowledged has been read from the store once.
What a copy replaces has the same bytes, or is damaged.

A reader gets a checked copy on the disk of this machine (`copies`), because analyses and players
read a file many times.
"""

from __future__ import annotations

import hashlib
import time
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from typing_extensions import override

from app.errors import FileDamaged, NotFound, StorageError
from app.store.files.bucket import Bucket
from app.store.files.copies import FOLDER as COPIES
from app.store.files.copies import Copies
from app.store.files.files import FileStore, Readable, StagedFile, name_of
from app.store.files.hash_check import SHA256, HashChecker, refuse_damage
from app.store.files.id_file import NAME
from app.store.files.locked_file import remove_if_abandoned
from app.store.files.object_quarantine import ObjectQuarantine, name_here
from app.store.files.objects import Objects
from app.store.files.quarantine import DAY_S
from app.store.files.removal_hold import FolderHold
from app.store.files.staging import (
    TEMPORARIES,
    Hashed,
    disk_failures,
    staged_on_disk,
)
from app.store.folders import make_private_synced

ABANDONED_S = DAY_S
"""Age after which a temporary object counts as abandoned. If its process still lives, it sends the
bytes again."""


@dataclass(frozen=True, slots=True)
class _StagedObject(StagedFile):
    files: ObjectFiles

    @override
    def keep(self) -> None:
        self.files.keep(self.temporary, Hashed(self.sha256, self.size))


class ObjectFiles(FileStore):
    """The files below one prefix of a bucket."""

    reads_bytes = False  # the store checks its disks itself, and to read all of it may cost money

    def __init__(self, bucket: Bucket, library_id: str | None = None) -> None:
        """library_id: see `check_identity`. Raises ConfigurationError."""
        super().__init__(bucket.folder, library_id)
        self.name = f"the bucket {bucket.url}"
        self._objects = Objects(bucket)
        self._copies = Copies(bucket.folder / COPIES, bucket.cache_bytes)
        self._checked = HashChecker()
        self.quarantine = self._quarantine = ObjectQuarantine(self._objects, bucket.url)
        self.removal_hold = FolderHold(bucket.folder)
        with disk_failures():
            make_private_synced(bucket.folder)

    @override
    def read_id(self) -> str | None:
        try:
            content = b"".join(self._objects.read(NAME))
        except NotFound:
            return None
        return content.decode("ascii", errors="replace").strip() or None

    @override
    def write_id(self, library_id: str, *, replaces: bool = False) -> None:
        write = self._objects.replace if replaces else self._objects.create
        write(NAME, f"{library_id}\n".encode("ascii"))

    @override
    @contextmanager
    def stage(self, content: Readable, *, max_bytes: int | None = None) -> Iterator[StagedFile]:
        self.check_identity()
        with staged_on_disk(self.root / TEMPORARIES, content, max_bytes) as (temporary, hashed):
            try:
                if not self._has_whole(name_of(hashed.sha256), hashed):
                    self._send(temporary, hashed)
                yield _StagedObject(hashed.sha256, hashed.size, temporary, self)
            finally:
                with suppress(StorageError):  # a sweep removes what stays
                    self._objects.remove(_sent_name(temporary))

    def keep(self, temporary: Path, hashed: Hashed) -> None:
        """Gives the staged bytes their final name: see `StagedFile.keep`."""
        final, sent = name_of(hashed.sha256), _sent_name(temporary)
        try:
            self._objects.copy(sent, final)
        except NotFound:  # nothing was sent, because the bucket had the file
            if not self._has_size(final, hashed):
                self._send(temporary, hashed)
                self._objects.copy(sent, final)
        if not self._has_size(final, hashed):
            raise StorageError(f"The bucket does not have the file {hashed.sha256} after a copy")
        with suppress(OSError):  # without a copy, the first reader makes one
            self._copies.take(hashed.sha256, temporary)

    @override
    def path(self, sha256: str) -> Path:
        name = name_of(sha256)
        if self._objects.find(name) is None and not self.bring_back(sha256):
            self._copies.remove(sha256)
            self.suspects.add(sha256)
            raise NotFound(f"The file {sha256} is not in the store")
        return self._copies.find(sha256) or self._fetch(sha256)

    @override
    def has(self, sha256: str) -> bool:
        name = name_of(sha256)
        return self._objects.find(name) is not None or self._quarantine.has(sha256)

    @override
    def missing(self, names: Iterable[str]) -> frozenset[str]:
        # One list of everything costs less than a request for each name.
        present, here = set(self._quarantine), set(self)
        self._copies.keep_only(here)
        return frozenset(names) - here - present

    @override
    def checked_path(self, sha256: str) -> Path:
        path = self.path(sha256)
        try:
            self._checked.check(path)
        except (FileDamaged, OSError):  # the copy is damaged, or went meanwhile
            self._copies.remove(sha256)
            return self._fetch(sha256)
        return path

    @override
    def check(self, sha256: str) -> None:
        if not self.has(sha256):
            raise NotFound(f"The file {sha256} is not in the store")
        refuse_damage(sha256, self._hash_of(name_of(sha256)).sha256)

    @override
    def remove(self, sha256: str) -> None:
        self._objects.remove(name_of(sha256))
        self._quarantine.remove(sha256)
        self._copies.remove(sha256)

    @override
    def set_aside(self, sha256: str) -> None:
        with suppress(NotFound):
            self._quarantine.take(name_of(sha256), sha256)
        self._copies.remove(sha256)

    @override
    def bring_back(self, sha256: str) -> bool:
        name = name_of(sha256)
        if self._objects.find(name) is not None:
            self._quarantine.remove(sha256)
            return False
        return self._quarantine.give_back(name, sha256) or self._objects.find(name) is not None

    @override
    def remove_abandoned_temporaries(self) -> int:
        here = (self.root / TEMPORARIES).glob("up_*")
        removed = sum(remove_if_abandoned(path, Path.unlink) for path in here)
        for one in list(self._objects.below(TEMPORARIES)):
            if time.time() - one.modified.timestamp() > ABANDONED_S:
                self._objects.remove(one.name)
                removed += 1
        self._copies.keep_only(set(self))
        return removed

    @override
    def __iter__(self) -> Iterator[str]:
        for one in self._objects.below():
            sha256 = name_here(one)
            if SHA256.fullmatch(sha256) and one.name == name_of(sha256):
                yield sha256

    def _send(self, temporary: Path, hashed: Hashed) -> None:
        """Sends the bytes to a temporary name, and reads them back."""
        name = _sent_name(temporary)
        self._objects.upload(name, temporary)
        if not self._has_whole(name, hashed):
            raise StorageError("The bucket does not hold the bytes that it was sent")

    def _has_size(self, name: str, hashed: Hashed) -> bool:
        found = self._objects.find(name)
        return found is not None and found.size == hashed.size

    def _has_whole(self, name: str, hashed: Hashed) -> bool:
        return self._has_size(name, hashed) and self._hash_of(name) == hashed

    def _hash_of(self, name: str) -> Hashed:
        digest, size = hashlib.sha256(), 0
        for chunk in self._objects.read(name):
            digest.update(chunk)
            size += len(chunk)
        return Hashed(digest.hexdigest(), size)

    def _fetch(self, sha256: str) -> Path:
        """Makes a checked copy on this machine. Raises NotFound, FileDamaged, DiskFull."""
        pieces = _Pieces(self._objects.read(name_of(sha256)))
        with staged_on_disk(self.root / TEMPORARIES, pieces, None) as (temporary, hashed):
            try:
                refuse_damage(sha256, hashed.sha256)
            except FileDamaged:
                self.suspects.add(sha256)
                raise
            with disk_failures():
                return self._copies.take(sha256, temporary)


class _Pieces:
    """Pieces of bytes as something to read; each read gives one piece, whatever its size."""

    def __init__(self, pieces: Iterator[bytes]) -> None:
        self._pieces = pieces

    def read(self, _size: int, /) -> bytes:
        """The next piece that is not empty; none at the end."""
        return next((piece for piece in self._pieces if piece), b"")


def _sent_name(temporary: Path) -> str:
    return f"{TEMPORARIES}/{temporary.name}"
