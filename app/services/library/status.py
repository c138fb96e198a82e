"""The status of a library: how many clips and jobs it has, and how full its disk is."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime

from app.services.library.library import Library
from app.store.clips import versions
from app.store.upkeep import counts


@dataclass(frozen=True, slots=True)
class Queue:
    """Open jobs of one kind in one state; oldest_s: age of the oldest in seconds."""

    kind: str
    state: str
    count: int
    oldest_s: float


@dataclass(frozen=True, slots=True)
class Disk:
    """The disk of the library's files: free and total bytes."""

    free: int
    total: int


@dataclass(frozen=True, slots=True)
class LibraryStatus:
    """The status of a library. clips: the number of clips by state."""

    library_version: int
    clips: Mapping[str, int]
    jobs: tuple[Queue, ...]
    disk: Disk


def status_of(lib: Library) -> LibraryStatus:
    """The status of the library. Raises StorageError and OSError."""
    with lib.store.read() as tx:
        version, by_state = versions.version(tx), counts.count_clips_by_state(tx)
        open_jobs = counts.count_open_jobs(tx)
    now = datetime.now(UTC)
    queues = tuple(
        Queue(one.kind, one.state, one.count, max((now - one.oldest).total_seconds(), 0.0))
        for one in open_jobs
    )
    usage = shutil.disk_usage(lib.store.files.root)
    return LibraryStatus(version, by_state, queues, Disk(usage.free, usage.total))
