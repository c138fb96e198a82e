"""Names of the processes that hold leases; they tell whether the holder is dead.

A name holds the machine, the run of its kernel and the process. Another process of the same
machine can tell from it at once that the holder is gone. It can tell nothing about holders on
other machines: `abandoned` watches their heartbeats.
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
"""Place of a process's start time behind its name in /proc/PID/stat (proc(5), field 22)."""

_ENDED = ("Z", "X")
"""States of processes that have ended and that their parent has not asked about."""


def new_owner(prefix: str) -> str:
    """A name for this process: `PREFIX_ID@HOST/KERNEL/NAMESPACE:PID:START`."""
    pid = os.getpid()
    return f"{new_id(prefix)}@{_process_table()}:{pid}:{_started(pid)}"


def is_gone(owner: str) -> bool:
    """Whether the process of this name is certainly dead; False where nobody can tell."""
    told = _Name.of(owner)
    if told is None or told.process_table != _process_table() or not _can_look():
        return False
    return _started(told.pid) != told.started


@dataclass(frozen=True, slots=True)
class _Name:
    process_table: str
    pid: int
    started: str

    @classmethod
    def of(cls, owner: str) -> _Name | None:
        """What a name holds; None for a name of another form."""
        parts = owner.partition("@")[2].rsplit(":", 2)
        if len(parts) != 3 or not parts[1].isdigit() or not parts[2]:
            return None
        return cls(parts[0], int(parts[1]), parts[2])


@cache
def _process_table() -> str:
    """Host, run of the kernel, and the namespace of process numbers: containers have their own."""
    try:
        kernel = (_PROC / "sys/kernel/random/boot_id").read_text().strip()
        namespace = (_PROC / "self/ns/pid").readlink().name
    except OSError:
        kernel = namespace = "unknown"
    return f"{socket.gethostname()}/{kernel}/{namespace}"


def _can_look() -> bool:
    """Whether this process sees others' entries in /proc (it may be told not to)."""
    return bool(_started(1) and _started(os.getpid()))


def _started(pid: int) -> str:
    """When a process began, in clock ticks since the kernel did; empty where it is gone."""
    try:
        line = (_PROC / str(pid) / "stat").read_text()
    except OSError:
        return ""
    fields = line.rpartition(")")[2].split()
    return "" if fields[0] in _ENDED else fields[_START_TIME]
