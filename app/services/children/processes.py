"""How child processes are made: quickly, small, and so that they die with their parent.

They are forked from a server process that has imported the numerical libraries, which takes
seconds, and does nothing else: one that had to be killed is replaced at once, and all share
the libraries' memory.
"""

from __future__ import annotations

import multiprocessing
import multiprocessing.connection
import multiprocessing.context
import os
import resource
import sys
import threading
import types
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from multiprocessing.popen_forkserver import Popen
from multiprocessing.process import BaseProcess

from app.json_stderr import STDERR, log_uncaught
from app.logs import configure_logging

LIBRARIES = [
    "app.analysis.analyze",
    "app.formats.read",
    "app.motion.canonical.canonical",
    "hmmlearn.hmm",
    # SciPy imports these parts on first use, and some take half a second.
    "scipy.fft",
    "scipy.interpolate",
    "scipy.linalg",
    "scipy.ndimage",
    "scipy.signal",
]
"""What an analysis needs; the server process imports it once for its children."""

one_at_a_time = threading.RLock()
"""Held while a child is started or asked how it ended: multiprocessing's own lists of children,
and its numbers on pipes, are not made for several threads."""


class _Process(multiprocessing.context.ForkServerProcess):
    """A child that does not import the parent's main module."""

    @staticmethod
    def _Popen(process_obj: BaseProcess) -> Popen:
        with _main_module_hidden():
            return multiprocessing.context.ForkServerProcess._Popen(process_obj)


class _Context(multiprocessing.context.ForkServerContext):
    Process = _Process


def child_context() -> multiprocessing.context.BaseContext:
    """The way to make children; one server process for each process that asks."""
    context = _Context()
    context.set_forkserver_preload(LIBRARIES)
    return context


def import_libraries() -> None:
    """Import what an analysis needs into this process, so that no first request waits for it."""
    for name in LIBRARIES:
        import_module(name)


@contextmanager
def _main_module_hidden() -> Iterator[None]:
    """While a child is described to the server, let the main module be an empty one.

    multiprocessing would have each child import it: the whole command line, or the API.
    """
    with one_at_a_time:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = types.ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


def log_like_parent(level: str) -> None:
    """Have this child process log lines of JSON; level: the least severity, as its parent logs."""
    configure_logging(level)
    log_uncaught()


def die_with_parent() -> None:
    """Have this child process exit at once when its parent is gone, however it went.

    A thread waits on the pipe that the parent holds open. (Linux's PR_SET_PDEATHSIG would
    fire when the parent's *thread* that started the child ends, and requests' threads end.)
    """
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_exit_after, args=(parent.sentinel,), daemon=True).start()


def _exit_after(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


def limit_memory(memory_mb: int) -> None:
    """Let this process take `memory_mb` MB of address space, libraries included."""
    limit = memory_mb * 2**20
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))


@contextmanager
def stderr_silenced() -> Iterator[None]:
    """Let nothing reach this process's standard error, which holds lines of JSON.

    Decoders in C (libmpg123) write there past Python. For children, which do one thing at a time.
    """
    kept, nowhere = os.dup(STDERR), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nowhere, STDERR)
        yield
    finally:
        os.dup2(kept, STDERR)
        os.close(kept)
        os.close(nowhere)
