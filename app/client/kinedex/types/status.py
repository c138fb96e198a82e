"""Answers: status. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class DiskStatus(Record):
    """The disk of the library's files.

    free: Bytes.
    total: Bytes.
    """

    free: int
    total: int


@dataclass(frozen=True, slots=True)
class IsolationStatus(Record):
    """What the kernel of the API's machine keeps from processes that read uploaded files.

    files: Other files than the one that they read.
    processes: Starting other processes.
    """

    files: bool
    network: bool
    processes: bool


@dataclass(frozen=True, slots=True)
class QueueStatus(Record):
    """Open jobs of one kind in one state.

    oldest_s: Age of the oldest of them, seconds.
    """

    kind: str
    state: str
    count: int
    oldest_s: float


@dataclass(frozen=True, slots=True)
class Status(Record):
    """What the library holds, what waits, and how full its disk is.

    version: The version of Kinedex.
    clips: Number of clips by state.
    jobs: Open jobs by kind and state, the oldest first.
    """

    version: str
    library_version: int
    clips: dict[str, int]
    jobs: list[QueueStatus]
    disk: DiskStatus
    isolation: IsolationStatus
