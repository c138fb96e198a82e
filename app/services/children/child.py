"""One child process that does one task at a time, and the reason of its end if it died."""

from __future__ import annotations

import multiprocessing.connection
import os
import signal
import time
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Self

from app.errors import AnalysisCrashed, AnalysisInterrupted
from app.kinedex_error import KinedexError
from app.services.children import given_files
from app.services.children.processes import child_context, die_with_parent, one_at_a_time
from app.services.children.sandbox import limit_cpu

START_TRIES = 5
"""The server that forks children may be killed; the next try starts another one."""
START_PAUSE_S = 0.2
MAX_BEGIN_S = 60.0
"""Time for a child to take a task: it may have to import the modules of the task first."""
MAX_END_S = 5.0
"""Time for a child to end after its pipe was closed, and for the server to report its exit code."""
UNKNOWN_EXIT_CODE = 255
"""The exit code that multiprocessing reports if the server that knew the code has died."""
OUTSIDE_SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that a process does not raise by its own work."""
_VMSTAT = Path("/proc/vmstat")


class ChildDied(AnalysisCrashed):
    """The analysis process died by its own work (a crash, or out of memory)."""


class ChildEnded(Exception):
    """A child process died while it worked.

    exit_code: minus the number of the signal if a signal killed it; None if it is unknown;
    memory_was_short: whether the kernel killed a process because of too little memory while the
    child worked; had_begun: whether the child had taken the task.
    """

    def __init__(
        self,
        exit_code: int | None,
        *,
        memory_was_short: bool = False,
        had_begun: bool = True,
    ) -> None:
        super().__init__(f"the child process ended ({_exit_text(exit_code)})")
        self.exit_code = exit_code
        self.memory_was_short = memory_was_short
        self.had_begun = had_begun

    @property
    def is_from_outside(self) -> bool:
        """Whether another process killed the child, so that its task was not the cause."""
        if self.exit_code is None:
            return True
        # The kernel kills with SIGKILL if memory is short. Then the task may be the cause.
        return -self.exit_code in OUTSIDE_SIGNALS and not self.memory_was_short

    @property
    def how(self) -> str:
        """The exit code or signal, in words."""
        return _exit_text(self.exit_code)

    def as_failure(self) -> KinedexError:
        """AnalysisInterrupted if the child was killed from outside, else ChildDied."""
        if self.is_from_outside:
            return AnalysisInterrupted(f"The process was stopped from outside ({self.how}).")
        return ChildDied(f"The process died ({self.how}).")


@dataclass(frozen=True, slots=True)
class Answer:
    """The result of a task, or the error that it raised."""

    value: Any = None
    failure: BaseException | None = None


@dataclass(frozen=True, slots=True)
class Task:
    """Work for a child. seconds: its time limit; files: paths of the files that it may open."""

    work: Callable[..., Any]
    arguments: tuple[Any, ...]
    seconds: float | None = None
    files: tuple[str, ...] = ()


class Child:
    """A child process. It and its parent have the two ends of one pipe, which no other has."""

    def __init__(self, process: BaseProcess, pipe: Connection) -> None:
        self.tasks = 0
        self._process, self._pipe = process, pipe

    @classmethod
    def start(cls, prepare: Callable[..., None], arguments: tuple[Any, ...]) -> Self:
        """A new child that calls `prepare` first. Raises ChildEnded if no child can be started."""
        for _ in range(START_TRIES):
            ours, theirs = multiprocessing.connection.Pipe()
            try:
                with one_at_a_time:
                    process = child_context().Process(  # type: ignore[attr-defined]
                        target=_serve, args=(theirs, prepare, arguments), daemon=True
                    )
                    process.start()
            except (OSError, EOFError):
                ours.close()
                time.sleep(START_PAUSE_S)
            else:
                return cls(process, ours)
            finally:
                theirs.close()
        raise ChildEnded(None)

    def do(self, task: Task) -> Answer:
        """Do one task in the child. Raises ChildEnded, and TimeoutError after `task.seconds`.

        Raises OSError if a file of the task cannot be opened.
        """
        self.tasks += 1
        with given_files.opened(task.files) as descriptors:
            self._begin(task, descriptors)
        kills = _memory_kills()
        try:
            failure, value = self._receive(task.seconds)
        except TimeoutError:
            self.kill()
            raise
        except (EOFError, OSError):
            raise self._as_end(memory_was_short=_memory_kills() > kills) from None
        return Answer(value, failure)

    def _begin(self, task: Task, descriptors: Sequence[int]) -> None:
        """Wait until the child has taken the task. Raises ChildEnded."""
        try:
            self._pipe.send(task)
            given_files.send(self._pipe, descriptors, self._process.pid or 0)
            self._receive(MAX_BEGIN_S)
        except TimeoutError:
            self.kill()
            raise ChildEnded(None, had_begun=False) from None
        except (EOFError, OSError):
            raise self._as_end(had_begun=False) from None

    def _as_end(self, *, memory_was_short: bool = False, had_begun: bool = True) -> ChildEnded:
        self._wait_for_end()
        code = self._exit_code()
        return ChildEnded(code, memory_was_short=memory_was_short, had_begun=had_begun)

    def _receive(self, seconds: float | None) -> Any:
        if not self._pipe.poll(seconds):
            raise TimeoutError
        return self._pipe.recv()

    def has_ended(self) -> bool:
        """Whether the child died while it was idle: an idle child sends nothing."""
        try:
            return self._pipe.poll(0)
        except OSError:
            return True

    def kill(self) -> None:
        """Kill the child; a caller that waits in `do` gets ChildEnded."""
        # By its process id: after the death of the server, multiprocessing assumes that all
        # children are dead, and does not kill them.
        if self._process.pid is not None:
            with suppress(ProcessLookupError):
                os.kill(self._process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Close the pipe, so that the child ends; kill it if it does not."""
        self._pipe.close()
        if not self._wait_for_end():
            self.kill()
            self._wait_for_end()
        self._exit_code()

    def _wait_for_end(self) -> bool:
        return bool(multiprocessing.connection.wait([self._process.sentinel], MAX_END_S))

    def _exit_code(self) -> int | None:
        """The exit code of the child; None if it is unknown."""
        with one_at_a_time:  # two threads at once would read each other's answer of the server
            self._process.join(0)
            code = self._process.exitcode
        return None if code == UNKNOWN_EXIT_CODE else code


def _serve(pipe: Connection, prepare: Callable[..., None], arguments: tuple[Any, ...]) -> None:
    """The loop of the child: do tasks until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C must stop the parent, not the child
    prepare(*arguments)
    die_with_parent()  # after `prepare`: a sandbox holds only for the threads that start after it
    with suppress(EOFError):
        while True:
            task: Task = pipe.recv()
            limit_cpu(task.seconds)
            with given_files.received(pipe, task.files):
                pipe.send("begun")
                _answer(pipe, task.work, task.arguments)


def _answer(pipe: Connection, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Send (failure, value); a failure that cannot be sent becomes a RuntimeError."""
    # `send` pickles before it writes, so that after a failure another answer can still be sent.
    try:
        pipe.send((None, work(*arguments)))
    except BaseException as failure:  # noqa: BLE001 - the parent raises it again
        trace = "".join(traceback.format_exception(failure))
        try:
            failure.add_note(trace)
            pipe.send((failure, None))
        except Exception:  # noqa: BLE001 - the failure cannot be pickled
            pipe.send((RuntimeError(trace), None))


def _memory_kills() -> int:
    """How many processes the kernel of this machine has killed because of too little memory."""
    try:
        lines = _VMSTAT.read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))


def _exit_text(exit_code: int | None) -> str:
    if exit_code is None:
        return "for an unknown reason"
    return f"killed by signal {-exit_code}" if exit_code < 0 else f"exit code {exit_code}"
