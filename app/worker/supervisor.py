"""Keeps the processes of one machine running: the API and, unless elsewhere, a worker.

A process that dies is started again, later each time it dies young. One that says that it
cannot start (a taken port, an old database: exit code CANNOT_START) ends the whole. SIGTERM and
SIGINT are passed on as SIGTERM, and the processes get time to finish; should the supervisor
itself be killed, the kernel tells them.
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
from collections.abc import Sequence
from dataclasses import dataclass, field

from pydantic import SecretStr

from app.config import ENV_PREFIX, Settings
from app.services.exposure import CANNOT_START

_log = logging.getLogger(__name__)

API = ("-P", "-m", "app.api.server")
WORKER = ("-P", "-m", "app.worker")
"""What Python runs for each; modules, so that this layer need not import the API."""

POLL_S = 0.2
STEADY_S = 10.0
"""A process that ran so long has started well; its next death is its first again."""
FIRST_DELAY_S, LONGEST_DELAY_S = 0.5, 30.0
"""Before a process that died is started again: doubled each time it dies young."""
GRACE_S = 15.0
"""To finish after SIGTERM, before SIGKILL."""
_PR_SET_PDEATHSIG = 1


@dataclass(slots=True)
class Kept:
    """A process that is to run: its name and Python's arguments, and how it fares."""

    name: str
    arguments: Sequence[str]
    process: subprocess.Popen[bytes] | None = None
    started: float = 0.0
    next_start: float = 0.0
    delay: float = FIRST_DELAY_S
    has_been_steady: bool = field(default=False)


def supervise(settings: Settings, with_worker: bool = True) -> int:
    """Run the API, and a worker, until SIGTERM or SIGINT; returns the exit code.

    Call it from the main thread. 0 after a signal; else the code of a process that could not
    start.
    """
    kept = [Kept("api", API)]
    if with_worker:
        kept.append(Kept("worker", WORKER))
    stop = threading.Event()
    before = {s: signal.signal(s, lambda *_: stop.set()) for s in (signal.SIGTERM, signal.SIGINT)}
    try:
        return keep_running(kept, environment(settings), stop)
    finally:
        for sign, handler in before.items():
            signal.signal(sign, handler)


def keep_running(kept: Sequence[Kept], environ: dict[str, str], stop: threading.Event) -> int:
    """Start each process, and again when it dies, until `stop`; then end them all."""
    try:
        while not stop.is_set():
            for one in kept:
                code = _look_after(one, environ)
                if code is not None:
                    return code
            stop.wait(POLL_S)
        return 0
    finally:
        _end(kept)


def environment(settings: Settings) -> dict[str, str]:
    """This process's environment with every setting in force, for processes to come."""
    environ = dict(os.environ)
    for name in type(settings).model_fields:
        value = getattr(settings, name)
        if value is not None:
            environ[ENV_PREFIX + name.upper()] = _written(value)
    return environ


def _written(value: object) -> str:
    if isinstance(value, SecretStr):
        return value.get_secret_value()
    if isinstance(value, tuple):
        return ",".join(value)
    return str(value).lower() if isinstance(value, bool) else str(value)


def _look_after(one: Kept, environ: dict[str, str]) -> int | None:
    """Start what is to run and does not; its exit code where it cannot start."""
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
    one.delay = min(2 * one.delay, LONGEST_DELAY_S)
    return None


def _start(one: Kept, environ: dict[str, str]) -> None:
    # A session of its own: a terminal's Ctrl-C reaches us alone, and we pass it on once.
    one.process = subprocess.Popen(  # noqa: S603 - our own interpreter and modules
        [sys.executable, *one.arguments],
        env=environ,
        start_new_session=True,
        preexec_fn=_die_with_supervisor,
    )
    one.started = time.monotonic()


def _die_with_supervisor() -> None:
    """In the child: SIGTERM when the supervisor dies (Linux; elsewhere nothing)."""
    prctl = getattr(ctypes.CDLL(None), "prctl", None)
    if prctl is not None:
        prctl(_PR_SET_PDEATHSIG, int(signal.SIGTERM), 0, 0, 0)


def _end(kept: Sequence[Kept]) -> None:
    alive = [one.process for one in kept if one.process is not None]
    for process in alive:
        process.terminate()
    deadline = time.monotonic() + GRACE_S
    for process in alive:
        try:
            process.wait(max(deadline - time.monotonic(), 0.1))
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
