"""CPU time and memory of process trees, and killing processes."""

from __future__ import annotations

import threading
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import psutil

SAMPLE_SECONDS = 0.2
MB = 1e6

Key = tuple[int, float]
"""Identifies a process also after its end: its id and its time of creation."""


def key_of(process: psutil.Process) -> Key:
    """The key of a process. A later process with the same id has another key."""
    return process.pid, process.create_time()


def tree_of(root: psutil.Process) -> list[psutil.Process]:
    """A process and all its descendants; empty if it has ended."""
    with suppress(psutil.Error):
        return [root, *root.children(recursive=True)]
    return []


def child_running(parent: psutil.Process, module: str) -> psutil.Process | None:
    """The child of `parent` that runs `python -m module`."""
    with suppress(psutil.Error):
        for child in parent.children():
            with suppress(psutil.Error):
                if module in child.cmdline():
                    return child
    return None


def processes_over(folder: Path) -> list[psutil.Process]:
    """Every process whose environment names `folder`, also one whose parent has ended."""
    found = []
    for process in psutil.process_iter():
        with suppress(psutil.Error, OSError):
            if str(folder) in process.environ().values() and process.is_running():
                found.append(process)
    return found


def kill(processes: Iterable[psutil.Process]) -> None:
    """SIGKILL."""
    for process in processes:
        with suppress(psutil.Error):
            process.kill()


@dataclass
class Tree:
    """CPU time and memory of one tree of processes. Peaks are since `begin_phase`, in bytes.

    cpu: seconds by process, as last seen; memory: largest sum over the tree of the proportional
    set sizes (each shared page counted once); alone: largest resident set of one process.
    """

    cpu: dict[Key, float] = field(default_factory=dict)
    seen: set[Key] = field(default_factory=set)
    memory: int = 0
    alone: int = 0
    max_processes: int = 0

    def cpu_seconds(self) -> float:
        return sum(self.cpu.values())

    def begin_phase(self) -> None:
        self.memory = self.alone = self.max_processes = 0

    def sample(self, root: psutil.Process | None) -> None:
        members = tree_of(root) if root is not None else []
        total = 0
        for process in members:
            with suppress(psutil.Error):
                key, times = key_of(process), process.cpu_times()
                memory = process.memory_full_info()
                self.seen.add(key)
                self.cpu[key] = times.user + times.system
                total += memory.pss
                self.alone = max(self.alone, memory.rss)
        self.memory = max(self.memory, total)
        self.max_processes = max(self.max_processes, len(members))


class Meter:
    """Watches trees, each below the child of `parent` that runs the tree's module."""

    def __init__(self, parent: psutil.Process, modules: dict[str, str]) -> None:
        self.trees = {name: Tree() for name in modules}
        self._parent, self._modules = parent, modules
        self._stop = threading.Event()
        self._lock = threading.Lock()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def __enter__(self) -> Meter:
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()

    def sample(self) -> None:
        """Take a sample now."""
        with self._lock:
            for name, module in self._modules.items():
                self.trees[name].sample(child_running(self._parent, module))

    def cpu_seconds(self) -> dict[str, float]:
        """CPU seconds of each tree, now."""
        self.sample()
        return {name: tree.cpu_seconds() for name, tree in self.trees.items()}

    def begin_phase(self) -> None:
        """Reset the peaks."""
        with self._lock:
            for tree in self.trees.values():
                tree.begin_phase()
        self.sample()

    def _watch(self) -> None:
        while not self._stop.wait(SAMPLE_SECONDS):
            self.sample()
