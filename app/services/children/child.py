"""One child process that does one task at a time, and how it ended when it died."""

from __future__ import annotations

import multiprocessing.connection
import os
import signal
import time
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any, Self

from app.errors import AnalysisCrashed, AnalysisInterrupted, KinedexError
from app.services.children.processes import child_context, die_with_parent, one_at_a_time

START_TRIES = 5
"""The server that forks children may be killed; the next try starts another one."""
START_PAUSE_S = 0.2
BEGIN_WITHIN_S = 60.0
"""For a child to take a task: it may have to import what the task needs first."""
END_WITHIN_S = 5.0
"""For a child whose pipe is closed to end, and for the server to tell how it ended."""
UNKNOWN = 255
"""The exit code that multiprocessing gives when the server that knew it has died."""
FROM_OUTSIDE = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT, signal.SIGHUP)
"""Signals that a process does not raise by its own work."""
_VMSTAT = Path("/proc/vmstat")


class ChildDied(AnalysisCrashed):
    """The analysis process died by its own work (a crash, or out of memory)."""


class ChildEnded(Exception):
    """A child process died while it worked.

    exit_code: negative is minus the signal; None where nobody knows. memory_was_short: the
    kernel killed a process for want of memory while the child worked. had_begun: whether the
    child had taken the task.
    """

    def __init__(
        self,
        exit_code: int | None,
        *,
        memory_was_short: bool = False,
        had_begun: bool = True,
    ) -> None:
        super().__init__(f"the child process ended ({_told(exit_code)})")
        self.exit_code = exit_code
        self.memory_was_short = memory_was_short
        self.had_begun = had_begun

    @property
    def is_from_outside(self) -> bool:
        """Whether somebody killed it, so that its task is not to blame."""
        if self.exit_code is None:
            return True
        return -self.exit_code in FROM_OUTSIDE and not self.memory_was_short

    @property
    def how(self) -> str:
        """The exit code or signal, in words."""
        return _told(self.exit_code)

    def as_failure(self) -> KinedexError:
        """AnalysisInterrupted where it was killed from outside, else ChildDied."""
        if self.is_from_outside:
            return AnalysisInterrupted(f"The process was stopped from outside ({self.how}).")
        return ChildDied(f"The process died ({self.how}).")


@dataclass(frozen=True, slots=True)
class Answer:
    """What a task returned, or what it raised."""

    value: Any = None
    failure: BaseException | None = None


class Child:
    """A child process behind a pipe that only the two of them hold."""

    def __init__(self, process: BaseProcess, pipe: Connection) -> None:
        self.tasks = 0
        self._process, self._pipe = process, pipe

    @classmethod
    def start(cls, prepare: Callable[..., None], arguments: tuple[Any, ...]) -> Self:
        """A new child that calls `prepare` first. Raises ChildEnded where none can be started."""
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

    def do(
        self, work: Callable[..., Any], arguments: tuple[Any, ...], seconds: float | None
    ) -> Answer:
        """Have one task done. Raises ChildEnded, and TimeoutError after `seconds`."""
        self.tasks += 1
        self._begin(work, arguments)
        kills = _memory_kills()
        try:
            failure, value = self._receive(seconds)
        except TimeoutError:
            self.kill()
            raise
        except (EOFError, OSError):
            raise self._as_end(memory_was_short=_memory_kills() > kills) from None
        return Answer(value, failure)

    def _begin(self, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
        """Wait until the child has taken the task. Raises ChildEnded."""
        try:
            self._pipe.send((work, arguments))
            self._receive(BEGIN_WITHIN_S)
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
        """Whether it died while it had nothing to do: an idle child sends nothing."""
        try:
            return self._pipe.poll(0)
        except OSError:
            return True

    def kill(self) -> None:
        """Kill it; whoever waits in `do` gets ChildEnded."""
        # By its number: once the server is dead, multiprocessing takes all children for dead.
        if self._process.pid is not None:
            with suppress(ProcessLookupError):
                os.kill(self._process.pid, signal.SIGKILL)

    def end(self) -> None:
        """Let it end, and make sure that it does."""
        self._pipe.close()
        if not self._wait_for_end():
            self.kill()
            self._wait_for_end()
        self._exit_code()

    def _wait_for_end(self) -> bool:
        return bool(multiprocessing.connection.wait([self._process.sentinel], END_WITHIN_S))

    def _exit_code(self) -> int | None:
        """Its exit code; None where nobody knows it."""
        with one_at_a_time:  # two threads that ask at once would take each other's answer
            self._process.join(0)
            code = self._process.exitcode
        return None if code == UNKNOWN else code


def _serve(pipe: Connection, prepare: Callable[..., None], arguments: tuple[Any, ...]) -> None:
    """What the child runs: tasks, until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is for the parent
    die_with_parent()
    prepare(*arguments)
    with suppress(EOFError):
        while True:
            work, given = pipe.recv()
            pipe.send("begun")
            _answer(pipe, work, given)


def _answer(pipe: Connection, work: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    """Send (failure, value); a failure that cannot be sent becomes a RuntimeError."""
    # A pipe sends nothing of what it cannot pickle, so that another answer can still be sent.
    try:
        pipe.send((None, work(*arguments)))
    except BaseException as failure:  # noqa: BLE001 - it goes to whoever waits for the task
        told = "".join(traceback.format_exception(failure))
        try:
            failure.add_note(told)
            pipe.send((failure, None))
        except Exception:  # noqa: BLE001
            pipe.send((RuntimeError(told), None))


def _memory_kills() -> int:
    """How many processes this machine's kernel has killed for want of memory."""
    try:
        lines = _VMSTAT.read_text().splitlines()
    except OSError:
        return 0
    return sum(int(line.split()[1]) for line in lines if line.startswith("oom_kill "))


def _told(exit_code: int | None) -> str:
    if exit_code is None:
        return "nobody knows how"
    return f"killed by signal {-exit_code}" if exit_code < 0 else f"exit code {exit_code}"
