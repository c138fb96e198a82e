"""The store: a database and a file store that belong together."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Self, TypeVar

from app.errors import DiskFull, StorageError
from app.store import keyed_calls
from app.store.database.engine import ERASE_WAIT_S, Database, Tx
from app.store.files.files import FileStore
from app.store.files.reserve import Reserve
from app.store.jobs import removals

_log = logging.getLogger(__name__)
_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True)
class Store:
    """One for each process; safe to share between threads."""

    database: Database
    files: FileStore

    @classmethod
    def open(cls, database_url: str, files_dir: Path, library_id: str | None = None) -> Self:
        """Opens without looking: `identity.prepare` or `identity.check` do that.

        library_id: what they found; without it, files are taken to be the right ones.
        """
        database = Database(database_url)
        if library_id is not None:
            database.watch_file()
        return cls(database, FileStore(files_dir, library_id))

    def read(self) -> AbstractContextManager[Tx]:
        """A transaction that sees one snapshot."""
        return self.database.read()

    @contextmanager
    def write(self) -> Iterator[Tx]:
        """A transaction that is committed durably at the end of the block; do not nest.

        Files that it made unneeded (`removals.record`) are removed right after.
        """
        with self.database.write() as tx:
            yield tx
            keyed_calls.mark(tx)
            has_removals = removals.settle(tx)
        if has_removals:
            self.finish_removals()

    def write_even_when_full(self, work: Callable[[Tx], _Result]) -> _Result:
        """What `work` returns, of a write transaction that frees space.

        On a full disk it is tried again with the space that is kept in reserve for this, and
        that of the database's log. Raises DiskFull where even that is not enough.
        """
        try:
            with self.write() as tx:
                return work(tx)
        except DiskFull:
            if self._reserve is None:
                raise
            self._reserve.give_up()
            with suppress(StorageError):  # it may help, by what the log gives back
                self.erase_traces()
            try:
                with self.write() as tx:
                    return work(tx)
            finally:
                self._reserve.take_back()
        finally:
            self.make_reserve()

    def finish_removals(self) -> int:
        """Removes the files that are recorded to be removed; returns how many.

        What cannot be removed now stays recorded, and a later call tries again.
        """
        try:
            with self.database.write() as tx:
                return removals.finish(tx, self.files)
        except StorageError as problem:
            _log.warning("files could not be removed yet: %s", problem.detail)
            return 0

    def make_reserve(self) -> None:
        """Keeps some disk space in reserve, when there is room (`Reserve`)."""
        if self._reserve is not None:
            self._reserve.make()

    def erase_traces(self, wait_s: float = ERASE_WAIT_S) -> bool:
        """Writes what was removed over, also where the database keeps its latest changes.

        Waits so long for those who use it; whether nobody was in the way.
        """
        return self.database.erase_traces(wait_s)

    def close(self) -> None:
        """Gives back all connections."""
        self.database.close()

    @property
    def _reserve(self) -> Reserve | None:
        file = self.database.file
        return None if file is None else Reserve(file.path)
