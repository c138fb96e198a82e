"""Files in a folder of this machine, or of a file system that machines share.

Bytes are first written to a temporary file and synced. `StagedFile.keep` renames the file to
`<first two hex digits>/<next two>/<all 64>` and syncs the directories. So a file with its final
name is always complete, even after a crash.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from typing_extensions import override

from app.errors import FileDamaged, NotFound, StorageError
from app.store.files.files import FileStore, Readable, StagedFile, name_of
from app.store.files.hash_check import SHA256, HashChecker
from app.store.files.id_file import read_id, write_id
from app.store.files.locked_file import remove_if_abandoned
from app.store.files.quarantine import FOLDER, FolderQuarantine
from app.store.files.removal_hold import FolderHold
from app.store.files.staging import TEMPORARIES, disk_failures, staged_on_disk
from app.store.folders import make_private_synced, sync_folder


@dataclass(frozen=True, slots=True)
class _StagedFile(StagedFile):
    final: Path

    @override
    def keep(self) -> None:
        with disk_failures():
            make_private_synced(self.final.parent)
            self.temporary.replace(self.final)
            sync_folder(self.final.parent)


class LocalFiles(FileStore):
    """A directory of files by SHA-256; any number of processes may share it."""

    reads_bytes = True

    def __init__(self, root: Path, library_id: str | None = None) -> None:
        """library_id: the library of these files; with None, `check_identity` checks nothing."""
        super().__init__(root, library_id)
        self.name = f"the folder {root}"
        self.quarantine = self._quarantine = FolderQuarantine(root / FOLDER)
        self.removal_hold = FolderHold(root)
        self._checked = HashChecker()

    @override
    def read_id(self) -> str | None:
        with disk_failures():
            return read_id(self.root)

    @override
    def write_id(self, library_id: str, *, replaces: bool = False) -> None:
        with disk_failures():
            write_id(self.root, library_id, replaces=replaces)

    @override
    @contextmanager
    def stage(self, content: Readable, *, max_bytes: int | None = None) -> Iterator[StagedFile]:
        self.check_identity()
        with staged_on_disk(self.root / TEMPORARIES, content, max_bytes) as (temporary, hashed):
            yield _StagedFile(hashed.sha256, hashed.size, temporary, self._path_of(hashed.sha256))

    @override
    def path(self, sha256: str) -> Path:
        path = self._path_of(sha256)
        if not path.is_file() and not self.bring_back(sha256):
            self.suspects.add(sha256)
            raise NotFound(f"The file {sha256} is not in the store")
        return path

    @override
    def has(self, sha256: str) -> bool:
        return self._path_of(sha256).is_file() or (self._quarantine.folder / sha256).is_file()

    @override
    def checked_path(self, sha256: str) -> Path:
        path = self.path(sha256)
        try:
            with disk_failures():
                self._checked.check(path)
        except StorageError:
            self.suspects.add(sha256)
            raise
        return path

    @override
    def check(self, sha256: str) -> None:
        try:
            HashChecker().check(self.path(sha256))
        except FileNotFoundError as error:
            raise NotFound(f"The file {sha256} is not in the store") from error
        except OSError as error:
            raise FileDamaged(f"The stored file {sha256} cannot be read") from error

    @override
    def missing(self, names: Iterable[str]) -> frozenset[str]:
        return frozenset(name for name in names if not self.has(name))

    @override
    def remove(self, sha256: str) -> None:
        with disk_failures():
            self._path_of(sha256).unlink(missing_ok=True)
            self._quarantine.remove(sha256)

    @override
    def set_aside(self, sha256: str) -> None:
        path = self._path_of(sha256)
        if path.is_file():
            with disk_failures():
                self._quarantine.take(path)

    @override
    def bring_back(self, sha256: str) -> bool:
        with disk_failures():
            return self._quarantine.give_back(self._path_of(sha256))

    @override
    def remove_abandoned_temporaries(self) -> int:
        temporaries = [*(self.root / TEMPORARIES).glob("up_*"), *self.root.glob("id_*")]
        return sum(remove_if_abandoned(path, Path.unlink) for path in temporaries)

    @override
    def __iter__(self) -> Iterator[str]:
        for path in self.root.glob("[0-9a-f][0-9a-f]/[0-9a-f][0-9a-f]/*"):
            if SHA256.fullmatch(path.name):
                yield path.name

    def _path_of(self, sha256: str) -> Path:
        return self.root / name_of(sha256)
