"""Health of the store: the database, the folder of files, and the space on the disk.

Cheap checks run at each call: the database has still the same file and can be read, and the folder
of files belongs to the library. A test write is repeated after WRITE_INTERVAL_S. A background
thread reads all pages of the database: at the start, when its file was changed, from time to time,
and after a request met damage. Another thread reads the files (`FileWatch`).
"""

from __future__ import annotations

import logging
import os
import shutil
import threading
import time
from contextlib import suppress
from pathlib import Path

from sqlalchemy.exc import SQLAlchemyError

from app.errors import DatabaseDamaged, DatabaseGone, StorageError
from app.kinedex_error import Place
from app.store.clips import versions as library
from app.store.database.ids import new_id
from app.store.store import Store
from app.store.upkeep.file_watch import FileWatch

_log = logging.getLogger(__name__)

MIN_FREE_BYTES = 4 * 2**20
"""With less free space, most clips cannot be stored."""
WRITE_INTERVAL_S = 5.0
"""Time between two test writes."""
PAGE_CHECK_INTERVAL_S = 6 * 3600.0
"""Time between two checks of all pages of a database that does not change."""
MIN_PAGE_CHECK_INTERVAL_S = 10.0
"""Time between two checks of all pages of a database that changes or is damaged; a large database
needs more, see PAUSE_PER_WORK."""
PAUSE_PER_WORK = 50
"""The pause after a check of all pages, as a multiple of the time that the check took."""
POLL_S = 1.0
"""Time between two looks at whether a request met damage."""
STOP_TIMEOUT_S = 1.0

DATABASE, FILES, DISK = "database", "files", "disk"
"""Locations of troubles. Their messages say nothing about the library or the machine, because
anybody can read them without a key."""


class Health:
    """Checks one store; safe to share between threads.

    files: which stored files are missing or damaged. The service works without them, so they are no
    troubles.
    """

    def __init__(self, store: Store) -> None:
        self.files = FileWatch(store)
        self._store = store
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._check_pages, name="check-pages", daemon=True)
        self._is_damaged = False
        self._checked_at = -PAGE_CHECK_INTERVAL_S
        self._checked_change, self._check_took = -1, 0.0
        self._disk_troubles: tuple[Place, ...] = ()
        self._next_write = 0.0
        self._last_troubles: tuple[Place, ...] = ()

    def start(self) -> None:
        """Start the background checks of pages and files; they also make the reserve."""
        self._thread.start()
        self.files.start()

    def stop(self) -> None:
        """Stop the background checks. A check that is running ends with the process."""
        self._stop.set()
        self.files.stop()
        self._thread.join(STOP_TIMEOUT_S)

    def troubles(self) -> tuple[Place, ...]:
        """The current troubles of the store, empty if it works; each change is logged."""
        troubles = (*self._of_database(), *self._of_files(), *self._of_disk())
        if troubles != self._last_troubles:
            self._last_troubles = troubles
            messages = {place.location: place.message for place in troubles}
            _log.warning("health changed", extra={"fields": {"troubles": messages}})
        return troubles

    def _of_database(self) -> tuple[Place, ...]:
        try:
            with self._store.read() as tx:
                library_id = library.library_id(tx)
        except (DatabaseGone, DatabaseDamaged) as problem:
            return (Place(DATABASE, problem.title()),)
        except (StorageError, SQLAlchemyError):
            return (Place(DATABASE, "cannot be read"),)
        if self._is_damaged or self._store.database.damage is not None:
            return (Place(DATABASE, DatabaseDamaged.title()),)
        if self._store.files.library_id not in (None, library_id):
            return (Place(DATABASE, "belongs to another library than at the start"),)
        return ()

    def _of_files(self) -> tuple[Place, ...]:
        try:
            self._store.files.check_identity()
        except StorageError:
            return (Place(FILES, "the folder of files is missing or belongs to another library"),)
        return ()

    def _of_disk(self) -> tuple[Place, ...]:
        now = time.monotonic()
        if now >= self._next_write:
            self._disk_troubles = _disk_troubles(self._folders())
            self._next_write = now + WRITE_INTERVAL_S
        return self._disk_troubles

    def _folders(self) -> list[Path]:
        database = self._store.database.file
        folders = [self._store.files.root, *([] if database is None else [database.path.parent])]
        return [folder for folder in folders if folder.is_dir()]

    def _check_pages(self) -> None:
        while not self._stop.is_set():
            if self._is_check_due():
                self._check_once()
                self._store.make_reserve()
            self._stop.wait(POLL_S)

    def _is_check_due(self) -> bool:
        if self._store.database.damage is not None and not self._is_damaged:
            return True
        since = time.monotonic() - self._checked_at
        if since < max(MIN_PAGE_CHECK_INTERVAL_S, PAUSE_PER_WORK * self._check_took):
            return False
        is_changed = self._last_change() != self._checked_change
        return self._is_damaged or is_changed or since >= PAGE_CHECK_INTERVAL_S

    def _check_once(self) -> None:
        began, self._checked_change = time.monotonic(), self._last_change()
        with suppress(StorageError):  # deleted or locked: the next call of `troubles` reports it
            damage = self._store.database.find_damage(quick=True)
            if damage:
                _log.error("the database is damaged", extra={"fields": {"damage": damage}})
            was_damaged = self._is_damaged or self._store.database.damage is not None
            self._is_damaged = bool(damage)
            if was_damaged and not damage:
                self._store.database.clear_damage()
        self._checked_at = time.monotonic()
        self._check_took = self._checked_at - began

    def _last_change(self) -> int:
        """Modification time of the database's file, nanoseconds; 0 if it has none.

        A program that damages the file changes this time. A failing disk does not, so the pages
        are also checked from time to time.
        """
        file = self._store.database.file
        try:
            return 0 if file is None else file.path.stat().st_mtime_ns
        except OSError:
            return 0


def _disk_troubles(folders: list[Path]) -> tuple[Place, ...]:
    for folder in folders:
        try:
            is_full = shutil.disk_usage(folder).free < MIN_FREE_BYTES
            if not is_full:
                _try_to_write(folder)
        except OSError as error:
            return (Place(DISK, f"nothing can be written: {error.strerror}"),)
        if is_full:
            return (Place(DISK, "there is no space left"),)
    return ()


def _try_to_write(folder: Path) -> None:
    path = folder / new_id("probe")
    try:
        with path.open("xb", buffering=0) as file:
            file.write(os.urandom(4096))
    finally:
        path.unlink(missing_ok=True)
