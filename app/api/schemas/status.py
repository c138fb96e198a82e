"""The status of the library."""

from __future__ import annotations

from pydantic import Field

from app.api.schemas.base import Outgoing


class QueueStatus(Outgoing):
    """Open jobs of one kind in one state."""

    kind: str
    state: str
    count: int
    oldest_s: float = Field(description="Age of the oldest of them, seconds.")


class DiskStatus(Outgoing):
    """The disk of the library's files."""

    free: int = Field(description="Bytes.")
    total: int = Field(description="Bytes.")


class IsolationStatus(Outgoing):
    """What the kernel of the API's machine keeps from processes that read uploaded files."""

    files: bool = Field(description="Other files than the one that they read.")
    network: bool
    processes: bool = Field(description="Starting other processes.")


class Status(Outgoing):
    """What the library holds, what waits, and how full its disk is."""

    version: str = Field(description="The version of Kinedex.")
    library_version: int
    clips: dict[str, int] = Field(description="Number of clips by state.")
    jobs: list[QueueStatus] = Field(description="Open jobs by kind and state, the oldest first.")
    disk: DiskStatus
    isolation: IsolationStatus
