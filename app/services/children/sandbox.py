"""What a process that parses files from outside may do: compute, and nothing else.

A defect in a parser may run code of the file. Then this code can open no file but those of Python
and its libraries, and the ones that the parent opened for the task (`given_files`); no socket; it
can start no process, and send no signal to others; and its memory, CPU time and open files are
limited. Landlock and seccomp do this. Where the kernel has one of them not, the other limits hold,
`status` says what is missing, and the log warns.
"""

from __future__ import annotations

import logging
import os
import resource
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from app.services.children import landlock, seccomp
from app.store.folders import make_private

_log = logging.getLogger(__name__)

MAX_OPEN_FILES = 256
MAX_WRITTEN_BYTES = 64 * 2**20
"""The largest file that may be written: code that numba keeps."""
CPU_SLACK_S = 30
"""CPU time beyond the time limit of a task. The parent ends a late task; this ends it if the parent
is gone."""
NUMBA_CACHE = "NUMBA_CACHE_DIR"
"""The variable that names the folder in which numba keeps compiled code (librosa needs one)."""
JOBLIB = "JOBLIB_MULTIPROCESSING"
"""With the value 0, joblib (librosa loads it) does not try to make a lock, which the walls forbid:
it would warn of that in the log at each start of a process that hears music."""

_SYSTEM = (
    *("/usr/lib", "/usr/lib64", "/usr/local/lib", "/lib", "/lib64", "/etc/ld.so.cache"),
    *("/dev/urandom", "/dev/zero", "/proc/cpuinfo", "/proc/meminfo"),
    *("/sys/devices/system/cpu", "/usr/share/zoneinfo", "/etc/localtime"),
)
"""Files that the interpreter and numerical libraries read. Nothing of the library or of users."""
_NOWHERE = Path(os.devnull)
_NO_LIMIT = resource.RLIM_INFINITY


@dataclass(frozen=True, slots=True)
class SandboxStatus:
    """What the kernel can take from a process: other files, the network, new processes."""

    files: bool
    network: bool
    processes: bool

    @property
    def missing(self) -> tuple[str, ...]:
        """What the kernel cannot take."""
        names = {"files": "other files", "network": "the network", "processes": "new processes"}
        return tuple(text for name, text in names.items() if not getattr(self, name))


@dataclass(frozen=True, slots=True)
class Sandbox:
    """Folders and files that the process may read, and folders that it may write to."""

    readable: tuple[Path, ...]
    writable: tuple[Path, ...]

    @classmethod
    def of_this_program(cls, cache: Path | None) -> Sandbox:
        """Reading Python, its libraries and this program; writing to numba's cache.

        cache: the folder for numba, unless NUMBA_CACHE_DIR names one. Call it in the parent.
        """
        named = os.environ.get(NUMBA_CACHE)
        folder = Path(named) if named else cache
        return cls((*_libraries(), *map(Path, _SYSTEM)), () if folder is None else (folder,))

    def make_folders(self) -> None:
        """Make the folders to write to, in the parent: only what exists can be allowed."""
        for folder in self.writable:
            with suppress(OSError):  # then nothing is kept there
                make_private(folder)

    def enter(self, memory_mb: int) -> None:
        """Take everything else from this process, which must have one thread.

        memory_mb: its address space, libraries included.
        """
        if self.writable:
            os.environ.setdefault(NUMBA_CACHE, str(self.writable[0]))
        os.environ.setdefault(JOBLIB, "0")
        _limit(resource.RLIMIT_AS, memory_mb * 2**20)
        _limit(resource.RLIMIT_NOFILE, MAX_OPEN_FILES)
        _limit(resource.RLIMIT_FSIZE, MAX_WRITTEN_BYTES)
        _limit(resource.RLIMIT_CORE, 0)
        # Threads have folders below this one; those of other processes hold their secrets.
        own = Path("/proc/self").resolve()
        _try(lambda: landlock.restrict((*self.readable, own), (*self.writable, _NOWHERE)))
        _try(seccomp.restrict)


def status() -> SandboxStatus:
    """What holds on this machine."""
    version, has_filter = landlock.abi(), seccomp.is_known()
    return SandboxStatus(
        files=version > 0,
        network=has_filter or version >= landlock.NETWORK_ABI,
        processes=has_filter,
    )


def limit_cpu(seconds: float | None) -> None:
    """End this process if it computes longer than `seconds` from now on, on all cores."""
    hard = resource.getrlimit(resource.RLIMIT_CPU)[1]
    if seconds is None:
        resource.setrlimit(resource.RLIMIT_CPU, (hard, hard))
        return
    used = resource.getrusage(resource.RUSAGE_SELF)
    cores = len(os.sched_getaffinity(0))
    end = int(used.ru_utime + used.ru_stime + seconds * cores + CPU_SLACK_S) + 1
    resource.setrlimit(resource.RLIMIT_CPU, (end if hard == _NO_LIMIT else min(end, hard), hard))


def _libraries() -> Sequence[Path]:
    """Folders of Python and of the packages that are loaded."""
    folders = {Path(sys.prefix), Path(sys.base_prefix), Path(os.__file__).parent}
    for name, module in [*sys.modules.items()]:
        # The folder of the package alone: beside it there may be a library of clips.
        if "." not in name and (file := getattr(module, "__file__", None)):
            path = Path(file)
            folders.add(path.parent if hasattr(module, "__path__") else path)
    return sorted(folders)


def _limit(which: int, value: int) -> None:
    hard = resource.getrlimit(which)[1]
    value = value if hard == _NO_LIMIT else min(value, hard)
    resource.setrlimit(which, (value, value))


def _try(restrict: Callable[[], None]) -> None:
    # The parent has warned about a kernel without it (`status`).
    try:
        restrict()
    except OSError as problem:
        _log.info("an analysis process has fewer walls: %s", problem)
