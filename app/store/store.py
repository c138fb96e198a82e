"""The store: the database and the files of one library."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from typing import Self, TypeVar

from app.errors import DiskFull, StorageError
from app.store import audit, keyed_calls
from app.store.database.access import ServerOptions
from app.store.database.advisory_hold import AdvisoryHold
from app.store.database.engine import ERASE_WAIT_S, Database, Tx
from app.store.files.bucket import Bucket, FilesPlace
from app.store.files.files import FileStore
from app.store.files.places import open_files
from app.store.files.reserve import Reserve
from app.store.jobs import removals

_log = logging.getLogger(__name__)
_Result = TypeVar("_Result")


@dataclass(frozen=True, slots=True)
class Store:
    """The database and the files of a library. A process opens one; threads may share it."""

    database: Database
    files: FileStore

    @classmethod
    def open(
        cls,
        database_url: str,
        files_at: FilesPlace,
        library_id: str | None = None,
        options: ServerOptions | None = None,
    ) -> Self:
        """Opens a store without a check; call `identity.prepare` or `identity.check` before.

        library_id: the id that they returned. With None, nothing checks later that the place of
        the files is the right one. Raises ConfigurationError.
        """
        database = Database(database_url, options=options)
        if library_id is not None:
            database.watch_file()
        files = open_files(files_at, library_id)
        if isinstance(files_at, Bucket) and not database.is_sqlite:
            files.removal_hold = AdvisoryHold(database)
        return cls(database, files)

    def read(self) -> AbstractContextManager[Tx]:
        """A transaction that reads one snapshot of the database."""
        return self.database.read()

    @contextmanager
    def write(self) -> Iterator[Tx]:
        """A transaction that is committed durably at the end of the block; do not nest.

        The files that it recorded for removal (`removals.record`) are removed after the commit.
        """
        with self.database.write() as tx:
            yield tx
            keyed_calls.mark(tx)
            audit.record(tx)
            has_removals = removals.settle(tx)
        audit.settle()
        if has_removals:
            self.finish_removals()

    def write_even_when_full(self, work: Callable[[Tx], _Result]) -> _Result:
        """Runs `work`, which frees space, in a write transaction, and returns its result.

        If the disk is full, `work` is called a second time, after the reserve (`Reserve`) and the
        log of the database gave their space back. Raises DiskFull if that is not enough.
        """
        try:
            with self.write() as tx:
                return work(tx)
        except DiskFull:
            if self._reserve is None:
                raise
            self._reserve.give_up()
            with suppress(StorageError):  # this helps only if the log has space to give back
                self.erase_traces()
            try:
                with self.write() as tx:
                    return work(tx)
            finally:
                self._reserve.take_back()
        finally:
            self.make_reserve()

    def finish_removals(self) -> int:
        """Removes the files that are recorded for removal; returns their number.

        A file that cannot be removed now stays recorded, and a later call tries again. While
        somebody copies the library (`RemovalHold`), no file is removed.
        """
        try:
            with self.database.write() as tx, self.files.removal_hold.free() as is_free:
                return removals.finish(tx, self.files) if is_free else 0
        except StorageError as problem:
            _log.warning("files could not be removed yet: %s", problem.detail)
            return 0

    def make_reserve(self) -> None:
        """Reserves disk space for deletions, if enough is free (`Reserve`)."""
        if self._reserve is not None:
            self._reserve.make()

    def erase_traces(self, wait_s: float = ERASE_WAIT_S) -> bool:
        """Overwrites deleted data, also in the log of the database.

        wait_s: seconds to wait for other users of the database. Returns False if they still used
        it, and then the log may still hold the data.
        """
        return self.database.erase_traces(wait_s)

    def rebuild(self) -> bool:
        """Removes traces of deleted data from the unused bytes of the database's file.

        Returns False if this was not possible: then call it again, or copy the database.
        """
        return self.database.rebuild()

    def close(self) -> None:
        """Closes all connections."""
        self.database.close()

    @property
    def _reserve(self) -> Reserve | None:
        file = self.database.file
        return None if file is None else Reserve(file.path)
