"""The file store: the original bytes of files, each named by its SHA-256.

A store is a folder (`local_files`) or a bucket (`object_files`). In both, a file with its final
name is complete, whatever crashed. `places.open_files` opens one.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO, Protocol

from app.errors import BadField, StorageError
from app.kinedex_error import Place
from app.store.files.hash_check import SHA256
from app.store.files.quarantine import Quarantine
from app.store.files.removal_hold import RemovalHold


class Readable(Protocol):
    """A source of bytes: a file, an upload, a member of an archive."""

    def read(self, size: int, /) -> bytes:
        """At most `size` bytes; none at the end."""
        ...


@dataclass(frozen=True, slots=True)
class StagedFile(ABC):
    """A synced file with a temporary name, which is not part of the store yet."""

    sha256: str
    size: int
    temporary: Path

    @abstractmethod
    def keep(self) -> None:
        """Makes the file part of the store. The store may already hold the same bytes.

        Call it in the write transaction that adds the row which refers to the file. Raises
        DiskFull, StorageError.
        """

    def open(self) -> BinaryIO:
        """The staged bytes, for reading before `keep`."""
        return self.temporary.open("rb")


class FileStore(ABC):
    """The files of a library; any number of processes may share them."""

    name: str
    """What messages call the place of the files."""
    reads_bytes: bool
    """Whether `FileWatch` shall read all files again and again, to find damage."""
    quarantine: Quarantine
    removal_hold: RemovalHold

    def __init__(self, root: Path, library_id: str | None) -> None:
        """root: a folder of this machine; library_id: see `check_identity`."""
        self.root = root
        self.library_id = library_id
        self.suspects: set[str] = set()
        """Files that somebody found missing or damaged; `FileWatch` takes them and looks again."""

    @abstractmethod
    def read_id(self) -> str | None:
        """The id of the library that the files belong to; None without one. Raises StorageError."""

    @abstractmethod
    def write_id(self, library_id: str, *, replaces: bool = False) -> None:
        """Writes the id. Without `replaces`, an existing id stays. Raises StorageError."""

    def check_identity(self) -> None:
        """Raises StorageError if the files do not belong to the library (any more).

        If the disk is not mounted, the folder is empty, and nothing may be stored in it. Without a
        `library_id`, nothing is checked.
        """
        if self.library_id is None:
            return
        found = self.read_id()
        if found != self.library_id:
            raise StorageError(
                f"{self.name[0].upper()}{self.name[1:]} is not the one of this library: its id is "
                f"{found or 'no id'}, and {self.library_id} is expected"
            )

    @abstractmethod
    def stage(
        self, content: Readable, *, max_bytes: int | None = None
    ) -> AbstractContextManager[StagedFile]:
        """Streams content to a temporary file, which is removed after the block unless `keep` ran.

        Raises TooLarge if the content has more than `max_bytes`; DiskFull; StorageError. Then
        nothing is left on the disk.
        """

    @abstractmethod
    def path(self, sha256: str) -> Path:
        """A path of the file on this machine; raises NotFound if the store does not have it.

        A file in the quarantine is moved back, because somebody needs it. Open it at once: where
        the store is a bucket, the path is of a copy, which goes when others need the space.
        """

    @abstractmethod
    def has(self, sha256: str) -> bool:
        """Whether the store or its quarantine has the file."""

    @abstractmethod
    def missing(self, names: Iterable[str]) -> frozenset[str]:
        """The names that neither the store nor its quarantine has. Raises StorageError."""

    def open(self, sha256: str) -> BinaryIO:
        """The file, for reading; raises NotFound."""
        return self.path(sha256).open("rb")

    @abstractmethod
    def checked_path(self, sha256: str) -> Path:
        """As `path`, but the file is checked for damage; raises FileDamaged too."""

    @abstractmethod
    def check(self, sha256: str) -> None:
        """Reads the whole file where it is stored. Raises NotFound, FileDamaged, StorageError."""

    @abstractmethod
    def remove(self, sha256: str) -> None:
        """Removes the file from the store and the quarantine, if it is there.

        `removals` decides whether a file may be removed.
        """

    @abstractmethod
    def set_aside(self, sha256: str) -> None:
        """Moves the file to the quarantine, if the store has it."""

    @abstractmethod
    def bring_back(self, sha256: str) -> bool:
        """Moves the file back from the quarantine; returns whether the store has it by that."""

    @abstractmethod
    def remove_abandoned_temporaries(self) -> int:
        """Removes the temporary files of dead processes; returns their number."""

    @abstractmethod
    def __iter__(self) -> Iterator[str]:
        """The SHA-256 of every file in the store."""


def name_of(sha256: str) -> str:
    """The name of a file below the root of a store. Raises BadField for what is no SHA-256.

    Such a text, as "../..", could lead out of the folder.
    """
    if not SHA256.fullmatch(sha256):
        raise BadField(places=[Place("sha256", "64 lower-case hex digits are expected")])
    return f"{sha256[:2]}/{sha256[2:4]}/{sha256}"
