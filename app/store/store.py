"""The store: a database and a file store that belong together."""

from __future__ import annotations

from collections.abc import Collection
from contextlib import AbstractContextManager
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from app.store import references
from app.store.engine import Database, Tx
from app.store.files import FileStore


@dataclass(frozen=True, slots=True)
class Store:
    """One for each process; safe to share between threads."""

    database: Database
    files: FileStore

    @classmethod
    def open(cls, database_url: str, files_dir: Path) -> Self:
        """Opens without looking at the schema: `schema.prepare` or `schema.check` do that."""
        return cls(Database(database_url), FileStore(files_dir))

    def read(self) -> AbstractContextManager[Tx]:
        """A transaction that sees one snapshot."""
        return self.database.read()

    def write(self) -> AbstractContextManager[Tx]:
        """A transaction that is committed durably at the end of the block; do not nest."""
        return self.database.write()

    def drop_unreferenced(self, sha256s: Collection[str]) -> None:
        """Removes those of the files that no clip and no open job refers to.

        Within a write transaction, so that no one adds a clip with the same bytes meanwhile
        (`StagedFile.keep` belongs into the write transaction of the clip for this reason).
        """
        with self.write() as tx:
            for sha256 in references.unreferenced(tx, sha256s):
                self.files.remove(sha256)

    def sweep_files(self) -> int:
        """Removes what interrupted uploads and deletions left; returns how many files."""
        swept = self.files.remove_stale_temporaries()
        with self.write() as tx:
            orphans = references.unreferenced(tx, list(self.files))
            for sha256 in orphans:
                self.files.remove(sha256)
        return swept + len(orphans)

    def erase_traces(self) -> None:
        """Writes what was removed over, also where the database keeps its latest changes."""
        self.database.erase_traces()

    def close(self) -> None:
        """Gives back all connections."""
        self.database.close()
