"""Keeps the processes of one machine running: the API and, unless it runs elsewhere, a worker.

A process that dies is started again. If it dies soon after its start, the delay before the next
start grows. If a process cannot start (exit code CANNOT_START: its port is in use, the database is
old), all processes end. The supervisor forwards SIGTERM and SIGINT as SIGTERM, and the processes
get time to finish. If the supervisor itself is killed, the kernel sends them SIGTERM.
"""

from __future__ import annotations

import ctypes
import logging
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence

from pydantic import SecretStr

from app.config import ENV_PREFIX, Settings
from app.services.exposure import CANNOT_START
from app.worker.api_processes import ApiProcesses
from app.worker.supervised import FIRST_DELAY_S, MAX_DELAY_S, SupervisedProcess

_log = logging.getLogger(__name__)

WORKER = ("-P", "-m", "app.worker")
"""Arguments of Python."""

POLL_S = 0.2
"""Time between two looks at the processes."""
STEADY_S = 10.0
"""A process that has run this long has started well: after its next death the delay is
FIRST_DELAY_S again."""
GRACE_S = 15.0
"""Time to finish after SIGTERM, before SIGKILL."""
_PR_SET_PDEATHSIG = 1
"""Option of prctl(2): the signal that a process gets when its parent dies."""


def supervise(settings: Settings, with_worker: bool = True) -> int:
    """Run the API, and a worker, until SIGTERM or SIGINT; returns the exit code.

    Call it from the main thread. The exit code is 0 after a signal, otherwise the code of a
    process that could not start. Raises ConfigurationError.
    """
    workers = [SupervisedProcess("worker", WORKER)] if with_worker else []
    stop = threading.Event()
    handlers = {s: signal.signal(s, lambda *_: stop.set()) for s in (signal.SIGTERM, signal.SIGINT)}
    try:
        apis = ApiProcesses(settings)
        with apis.all() as processes:
            return keep_running([*processes, *workers], environment(settings), stop, apis.close)
    finally:
        for sign, handler in handlers.items():
            signal.signal(sign, handler)


def keep_running(
    processes: Sequence[SupervisedProcess],
    environ: dict[str, str],
    stop: threading.Event,
    before_end: Callable[[], None] = lambda: None,
) -> int:
    """Start each process, and start it again when it dies, until `stop` is set; then end all.

    before_end: is called before the processes are told to end. Returns 0, or the exit code of a
    process that could not start.
    """
    try:
        while not stop.is_set():
            for process in processes:
                code = _look_after(process, environ)
                if code is not None:
                    return code
            stop.wait(POLL_S)
        return 0
    finally:
        before_end()
        _end(processes)


def environment(settings: Settings) -> dict[str, str]:
    """The environment of this process with all settings as variables, for its child processes."""
    environ = dict(os.environ)
    for name in type(settings).model_fields:
        value = getattr(settings, name)
        if value is not None:
            environ[ENV_PREFIX + name.upper()] = _as_variable(value)
    return environ


def _as_variable(value: object) -> str:
    if isinstance(value, SecretStr):
        return value.get_secret_value()
    if isinstance(value, tuple):
        return ",".join(value)
    return str(value).lower() if isinstance(value, bool) else str(value)


def _look_after(one: SupervisedProcess, environ: dict[str, str]) -> int | None:
    """Start the process if it does not run and its delay is over.

    Returns its exit code if it cannot start, None otherwise.
    """
    now = time.monotonic()
    if one.process is None:
        if now >= one.next_start:
            _start(one, environ)
        return None
    code = one.process.poll()
    if code is None:
        if now - one.started >= STEADY_S:
            one.has_been_steady, one.delay = True, FIRST_DELAY_S
        return None
    one.process = None
    if code == CANNOT_START and not one.has_been_steady:
        _log.error("%s cannot start", one.name)
        return code
    _log.warning("%s died (exit code %d); again in %.1f s", one.name, code, one.delay)
    one.next_start = now + one.delay
    one.delay = min(2 * one.delay, MAX_DELAY_S)
    return None


def _start(one: SupervisedProcess, environ: dict[str, str]) -> None:
    # In its own session: a terminal's Ctrl-C reaches the supervisor only, which forwards it once.
    one.process = subprocess.Popen(  # noqa: S603 - our own interpreter and modules
        [sys.executable, *one.arguments],
        env={**environ, **one.variables},
        pass_fds=one.files,
        start_new_session=True,
        preexec_fn=_die_with_supervisor,
    )
    one.started = time.monotonic()


def _die_with_supervisor() -> None:
    """Runs in the child: makes the kernel send it SIGTERM when the supervisor dies.

    Only Linux has this; on other systems nothing happens.
    """
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(_PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)


def _end(processes: Sequence[SupervisedProcess]) -> None:
    alive = [one.process for one in processes if one.process is not None]
    for process in alive:
        process.terminate()
    deadline = time.monotonic() + GRACE_S
    for process in alive:
        try:
            process.wait(max(deadline - time.monotonic(), 0.1))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
