"""Whether the store can do its work: database, folder of files, room on the disk.

What costs little is looked at each time it is asked: which file has the database's name, and
whether it can be read; which library the folder of files belongs to. Whether something can be
written is tried again after WRITE_EVERY_S. All pages of the database are read in the background:
at the start, when its file was changed, from time to time, and after a request met damage.
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

from app.errors import DatabaseDamaged, DatabaseGone, Place, StorageError
from app.store.clips import versions as library
from app.store.database.ids import new_id
from app.store.store import Store

_log = logging.getLogger(__name__)

MIN_FREE_BYTES = 4 * 2**20
"""Bytes: with less on the disk, hardly a clip can be stored."""
WRITE_EVERY_S = 5.0
"""Between two attempts to write."""
CHECK_EVERY_S = 6 * 3600.0
"""Between two looks at all pages of a database that did not change."""
CHECK_AGAIN_S = 10.0
"""The same, least, when its file was changed, or is damaged."""
WORK_SHARE = 50
"""Such a look is repeated after so many times the time that it took."""
LOOK_S = 1.0
"""Between two looks at whether a request met damage."""
STOP_WITHIN_S = 1.0

DATABASE, FILES, DISK = "database", "files", "disk"
"""Locations of troubles. What is said of them tells nothing of the library or the machine."""


class Health:
    """Looks after one store; safe to share between threads."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._check_pages, name="check-pages", daemon=True)
        self._is_damaged = False
        self._checked_at = -CHECK_EVERY_S
        self._checked_change, self._check_took = -1, 0.0
        self._room: tuple[Place, ...] = ()
        self._room_until = 0.0
        self._told: tuple[Place, ...] = ()

    def start(self) -> None:
        """Begin to check the database's pages in the background, and to keep a reserve."""
        self._thread.start()

    def stop(self) -> None:
        """Check no more. A check that takes long ends with the process."""
        self._stop.set()
        self._thread.join(STOP_WITHIN_S)

    def troubles(self) -> tuple[Place, ...]:
        """What keeps the store from its work, now; logged when it changes."""
        found = (*self._of_database(), *self._of_files(), *self._of_room())
        if found != self._told:
            self._told = found
            troubles = {place.location: place.message for place in found}
            _log.warning("health changed", extra={"fields": {"troubles": troubles}})
        return found

    def _of_database(self) -> tuple[Place, ...]:
        try:
            with self._store.read() as tx:
                found = library.library_id(tx)
        except (DatabaseGone, DatabaseDamaged) as problem:
            return (Place(DATABASE, problem.title()),)
        except (StorageError, SQLAlchemyError):
            return (Place(DATABASE, "cannot be read"),)
        if self._is_damaged or self._store.database.damage is not None:
            return (Place(DATABASE, DatabaseDamaged.title()),)
        if self._store.files.library_id not in (None, found):
            return (Place(DATABASE, "is of another library than at the start"),)
        return ()

    def _of_files(self) -> tuple[Place, ...]:
        try:
            self._store.files.check_identity()
        except StorageError:
            return (Place(FILES, "the folder of files is missing or belongs to another library"),)
        return ()

    def _of_room(self) -> tuple[Place, ...]:
        now = time.monotonic()
        if now >= self._room_until:
            self._room = _room_troubles(self._folders())
            self._room_until = now + WRITE_EVERY_S
        return self._room

    def _folders(self) -> list[Path]:
        database = self._store.database.file
        folders = [self._store.files.root, *([] if database is None else [database.path.parent])]
        return [folder for folder in folders if folder.is_dir()]

    def _check_pages(self) -> None:
        while not self._stop.is_set():
            if self._is_check_due():
                self._check_once()
                self._store.make_reserve()
            self._stop.wait(LOOK_S)

    def _is_check_due(self) -> bool:
        if self._store.database.damage is not None and not self._is_damaged:
            return True
        since = time.monotonic() - self._checked_at
        if since < max(CHECK_AGAIN_S, WORK_SHARE * self._check_took):
            return False
        is_changed = self._last_change() != self._checked_change
        return self._is_damaged or is_changed or since >= CHECK_EVERY_S

    def _check_once(self) -> None:
        began, self._checked_change = time.monotonic(), self._last_change()
        with suppress(StorageError):  # gone or locked: the next look tells
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
        """When the database's file was changed; a bad disk changes no time, but others do."""
        file = self._store.database.file
        try:
            return 0 if file is None else file.path.stat().st_mtime_ns
        except OSError:
            return 0


def _room_troubles(folders: list[Path]) -> tuple[Place, ...]:
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
