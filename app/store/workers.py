"""Heartbeats of workers: which workers are alive, and which ones hang.

Each worker has a small file in the folder of files, which it locks and writes at each heartbeat. A
table would be the wrong place: a worker that has nothing to do would change the database all the
time, and then `health` would read all pages of it again and again.

The kernel releases the lock of a dead worker, so its file is removed by whoever looks next. A
worker that hangs keeps the lock, but its heartbeat becomes old.
"""

from __future__ import annotations

import json
import logging
import os
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from app.store.files.locked_file import create_locked, remove_if_abandoned
from app.store.folders import make_private_synced
from app.store.jobs import owners

_log = logging.getLogger(__name__)

FOLDER = "workers"
"""Name of the folder of heartbeats, in the folder of files."""
FILE_BYTES = 1024
"""Every heartbeat has the same size, so that it also fits on a full disk."""


@dataclass(frozen=True, slots=True)
class LivingWorker:
    """A worker whose process lives.

    owner: its name, as in `owners`; age_s: seconds since its last heartbeat; memory_bytes: resident
    memory of its own process, without its analysis processes; 0 if the system does not say it.
    """

    owner: str
    age_s: float
    memory_bytes: int

    @property
    def is_here(self) -> bool:
        """Whether it runs on this machine, and in this container."""
        return owners.is_here(self.owner)


class Heartbeat:
    """The heartbeats of one worker."""

    def __init__(
        self,
        files_dir: Path,
        owner: str,
        interval_s: float,
        *,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """files_dir: the folder of files; owner: the name of the worker; interval_s: seconds
        between two heartbeats."""
        self._folder = files_dir / FOLDER
        self._owner, self._interval_s, self._clock = owner, interval_s, clock
        self._next = clock()
        self._file: tuple[Path, BinaryIO] | None = None

    def beat_if_due(self) -> None:
        """Write a heartbeat if the last one is old enough. A failure is only logged."""
        if self._clock() < self._next:
            return
        self._next = self._clock() + self._interval_s
        try:
            os.pwrite(self._open(), self._content(), 0)
        except OSError as error:
            _log.warning("the heartbeat of this worker cannot be written: %s", error.strerror)

    def end(self) -> None:
        """Remove the file: the worker ends as it should."""
        if self._file is not None:
            path, file = self._file
            with suppress(OSError):  # an empty file that stays is removed by the next look
                path.unlink(missing_ok=True)
                file.close()
            self._file = None

    def _open(self) -> int:
        if self._file is None:
            make_private_synced(self._folder)
            self._file = create_locked(self._folder, "beat")
        return self._file[1].fileno()

    def _content(self) -> bytes:
        beat = {
            "owner": self._owner,
            "machine": owners.machine(),
            "uptime_s": self._clock(),
            "memory_bytes": _memory_bytes(),
        }
        return json.dumps(beat).encode("ascii").ljust(FILE_BYTES)


def living(files_dir: Path) -> tuple[LivingWorker, ...]:
    """All workers whose processes live, by name. Files of dead workers are removed."""
    found = []
    for path in (files_dir / FOLDER).glob("beat_*"):
        with suppress(OSError, ValueError, LookupError, TypeError):  # it ended now, or begins
            if not remove_if_abandoned(path, Path.unlink):
                found.append(_read(path))
    return tuple(sorted(found, key=lambda one: one.owner))


def _read(path: Path) -> LivingWorker:
    beat = json.loads(path.read_bytes())
    if beat["machine"] == owners.machine():
        # All processes of a machine have the same monotonic clock, which nobody can set.
        age_s = time.monotonic() - beat["uptime_s"]
    else:
        age_s = time.time() - path.stat().st_mtime
    return LivingWorker(beat["owner"], max(age_s, 0.0), beat["memory_bytes"])


def _memory_bytes() -> int:
    try:
        pages = Path("/proc/self/statm").read_text().split()[1]
    except OSError:
        return 0
    return int(pages) * os.sysconf("SC_PAGE_SIZE")
