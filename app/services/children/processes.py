"""Starting child processes that start fast, use little memory and die with their parent.

They are forked from a server process, which only imports the numerical libraries. That import takes
seconds. So a child that was killed is replaced at once, and all children share the memory of the
libraries.
"""

from __future__ import annotations

import fcntl
import multiprocessing
import multiprocessing.connection
import multiprocessing.context
import os
import signal
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
    "app.numerics.hmm.fit",
    # SciPy imports these parts on first use, and some take half a second.
    "scipy.fft",
    "scipy.interpolate",
    "scipy.linalg",
    "scipy.ndimage",
    "scipy.signal",
]
"""Modules that an analysis needs. The server process imports them once for all children."""

one_at_a_time = threading.RLock()
"""Lock for starting a child and for reading its exit code: in multiprocessing neither the list of
children nor the messages from the server are safe for several threads."""


class _Process(multiprocessing.context.ForkServerProcess):
    """A child that does not import the parent's main module."""

    @staticmethod
    def _Popen(process_obj: BaseProcess) -> Popen:
        with _main_module_hidden():
            return multiprocessing.context.ForkServerProcess._Popen(process_obj)


class _Context(multiprocessing.context.ForkServerContext):
    Process = _Process


def child_context() -> multiprocessing.context.BaseContext:
    """The context that starts children. Each process that calls this has one server process."""
    context = _Context()
    context.set_forkserver_preload(LIBRARIES)
    return context


def import_libraries() -> None:
    """Import LIBRARIES into this process, so that the first request does not wait for them."""
    for name in LIBRARIES:
        import_module(name)


@contextmanager
def _main_module_hidden() -> Iterator[None]:
    """Replace the main module by an empty one while a child starts.

    multiprocessing would make each child import the main module: the command line, or the API.
    """
    with one_at_a_time:
        main = sys.modules["__main__"]
        sys.modules["__main__"] = types.ModuleType("__main__")
        try:
            yield
        finally:
            sys.modules["__main__"] = main


def log_like_parent(level: str) -> None:
    """Make this child process log JSON lines; level: the lowest severity that it logs."""
    configure_logging(level)
    log_uncaught()


def die_with_parent() -> None:
    """Make this child process exit at once when its parent has ended in any way.

    The parent keeps a pipe open. When it ends, the kernel sends SIGIO, which ends the child even if
    it is inside compiled code; a thread does the same where pipes send no signals. (Linux's
    PR_SET_PDEATHSIG does not fit: it kills the child when the server of children ends, and they
    work on without it.)
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    threading.Thread(target=_exit_after, args=(parent.sentinel,), daemon=True).start()
    if hasattr(os, "O_ASYNC"):
        signal.signal(signal.SIGIO, signal.SIG_DFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)


def _exit_after(sentinel: int) -> None:
    multiprocessing.connection.wait([sentinel])
    os._exit(1)


@contextmanager
def stderr_silenced() -> Iterator[None]:
    """Discard all output to this process's standard error, which must hold only JSON lines.

    Decoders in C (libmpg123) write there without Python, so the file descriptor is replaced. Only
    for children: they do one task at a time, and other threads would lose their output.
    """
    saved, devnull = os.dup(STDERR), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(devnull, STDERR)
        yield
    finally:
        os.dup2(saved, STDERR)
        os.close(saved)
        os.close(devnull)
