"""Reads all stored files again and again, slowly, and tells which are missing or damaged.

A missing file or a flipped bit is found only by a look at the file, and nobody opens most files for
months. So a background thread looks whether all files exist, and compares one file after the other
with its SHA-256. It takes about 1/PAUSE_PER_WORK of one core. It looks at once at a file that a
request found missing or damaged, and at each file that was bad before, to see its repair.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass

from sqlalchemy.exc import SQLAlchemyError

from app.errors import FileDamaged, NotFound
from app.kinedex_error import KinedexError
from app.store.jobs import references
from app.store.store import Store

_log = logging.getLogger(__name__)

POLL_S = 1.0
"""Shortest time between two steps."""
LOOK_INTERVAL_S = 30.0
"""Shortest time between two looks whether all files exist."""
PAUSE_PER_WORK = 50
"""The pause after a step, as a multiple of the time that the step took."""
MAX_PAUSE_S = 10.0
"""Longest pause after a step that hashed files, so that suspects do not wait."""
WORK_S = 0.02
"""Time to hash files in one step; one large file may take longer."""
STOP_TIMEOUT_S = 1.0
MAX_NAMES_LOGGED = 10


@dataclass(frozen=True, slots=True)
class BadFiles:
    """The names of the files that are missing, and of those that are damaged."""

    missing: frozenset[str] = frozenset()
    damaged: frozenset[str] = frozenset()

    def __bool__(self) -> bool:
        return bool(self.missing or self.damaged)

    @property
    def every(self) -> frozenset[str]:
        """All of their names."""
        return self.missing | self.damaged


class FileWatch:
    """Watches the files of one store; safe to share between threads."""

    def __init__(self, store: Store) -> None:
        self._store = store
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._watch, name="watch-files", daemon=True)
        self._bad = BadFiles()
        self._next_look = 0.0
        self._unread: Iterator[str] = iter(())

    def start(self) -> None:
        """Start to watch in the background."""
        self._thread.start()

    def stop(self) -> None:
        """Stop watching."""
        self._stop.set()
        self._thread.join(STOP_TIMEOUT_S)

    @property
    def bad(self) -> BadFiles:
        """The bad files that are known now."""
        return self._bad

    def step(self) -> None:
        """Look at what is due. Raises StorageError, OSError."""
        if time.monotonic() >= self._next_look or self._store.files.suspects or self._bad:
            self._look()
        if self._store.files.reads_bytes:
            self._read_some()

    def _watch(self) -> None:
        pause = 0.0
        while not self._stop.wait(max(POLL_S, min(pause, MAX_PAUSE_S))):
            began = time.monotonic()
            with suppress(KinedexError, OSError, SQLAlchemyError):  # `Health` reports these
                self.step()
            pause = PAUSE_PER_WORK * (time.monotonic() - began)

    def _look(self) -> None:
        """Find the files that do not exist, and hash the suspects and those that were bad."""
        began = time.monotonic()
        files = self._store.files
        doubtful = self._bad.every | {files.suspects.pop() for _ in range(len(files.suspects))}
        if began >= self._next_look:
            needed = self._needed()
            missing = set(files.missing(needed))
            took = time.monotonic() - began
            self._next_look = time.monotonic() + max(LOOK_INTERVAL_S, PAUSE_PER_WORK * took)
        else:
            needed = self._needed() if doubtful else frozenset()
            missing = {name for name in doubtful & needed if not files.has(name)}
        if missing:
            missing &= self._needed()  # without those whose clips were deleted meanwhile
        self._report(BadFiles(frozenset(missing), self._damaged((doubtful & needed) - missing)))

    def _read_some(self) -> None:
        """Hash the next files; after the last one, begin again with the first."""
        deadline = time.monotonic() + WORK_S
        while time.monotonic() < deadline:
            name = next(self._unread, None)
            if name is None:
                self._unread = iter(sorted(self._needed()))
                return
            if self._damaged((name,)):
                self._report(BadFiles(self._bad.missing, self._bad.damaged | {name}))

    def _needed(self) -> frozenset[str]:
        with self._store.read() as tx:
            return references.referenced(tx)

    def _damaged(self, names: Iterable[str]) -> frozenset[str]:
        """The damaged ones among `names`; a missing file is none."""
        damaged = set()
        for name in names:
            try:
                self._store.files.check(name)
            except NotFound:
                continue  # deleted meanwhile, or found missing by the next look
            except FileDamaged:
                damaged.add(name)
        return frozenset(damaged)

    def _report(self, bad: BadFiles) -> None:
        if bad == self._bad:
            return
        self._bad = bad
        fields = {
            "missing": sorted(bad.missing)[:MAX_NAMES_LOGGED],
            "damaged": sorted(bad.damaged)[:MAX_NAMES_LOGGED],
        }
        if bad:
            _log.error(
                "%d stored files are missing and %d are damaged: run `kinedex doctor --mend`",
                len(bad.missing),
                len(bad.damaged),
                extra={"fields": fields},
            )
        else:
            _log.warning("all stored files are there and undamaged again")
