"""Names of the processes that have leases. A name shows whether its process is dead.

A name contains the machine, the boot id of its kernel, and the process. With these, another
process on the same machine sees immediately that the owner is dead. It cannot see that for owners
on other machines: `abandoned_jobs` watches their heartbeats.
"""

from __future__ import annotations

import os
import socket
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from app.store.database.ids import new_id

_PROC = Path("/proc")
_START_TIME = 19
"""Index of the start time among the fields after the name in /proc/PID/stat (proc(5), field 22)."""

_ENDED = ("Z", "X")
"""States of processes that have ended, while their parent has not waited for them yet."""


def new_owner(prefix: str) -> str:
    """A name for this process: `PREFIX_ID@HOST/KERNEL/NAMESPACE:PID:START`."""
    pid = os.getpid()
    return f"{new_id(prefix)}@{_process_table()}:{pid}:{_started(pid)}"


def is_gone(owner: str) -> bool:
    """Whether the process with this name is certainly dead; False if that cannot be known."""
    name = _Name.parse(owner)
    if name is None or name.process_table != _process_table() or not _can_read_processes():
        return False
    # Another process may have the same number now, but not the same start time.
    return _started(name.pid) != name.started


def is_here(owner: str) -> bool:
    """Whether the process with this name belongs to this machine and to this container."""
    name = _Name.parse(owner)
    return name is not None and name.process_table == _process_table()


@cache
def machine() -> str:
    """The boot id of this machine's kernel; a random text if the system has none.

    Processes with the same text have the same monotonic clock, also in different containers.
    """
    try:
        return (_PROC / "sys/kernel/random/boot_id").read_text().strip()
    except OSError:
        return new_id("machine")


@dataclass(frozen=True, slots=True)
class _Name:
    process_table: str
    pid: int
    started: str

    @classmethod
    def parse(cls, owner: str) -> _Name | None:
        """The parts of a name; None for a name of another form."""
        parts = owner.partition("@")[2].rsplit(":", 2)
        if len(parts) != 3 or not parts[1].isdigit() or not parts[2]:
            return None
        return cls(parts[0], int(parts[1]), parts[2])


@cache
def _process_table() -> str:
    """Host, boot id of the kernel, and the namespace of process numbers, one for each container."""
    try:
        kernel = (_PROC / "sys/kernel/random/boot_id").read_text().strip()
        namespace = (_PROC / "self/ns/pid").readlink().name
    except OSError:
        kernel = namespace = "unknown"
    return f"{socket.gethostname()}/{kernel}/{namespace}"


def _can_read_processes() -> bool:
    """Whether this process can read other processes in /proc (mount option hidepid forbids it)."""
    return bool(_started(1) and _started(os.getpid()))


def _started(pid: int) -> str:
    """The start time of a process in clock ticks since boot; empty if it has ended."""
    try:
        line = (_PROC / str(pid) / "stat").read_text()
    except OSError:
        return ""
    fields = line.rpartition(")")[2].split()
    return "" if fields[0] in _ENDED else fields[_START_TIME]
