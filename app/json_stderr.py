"""Turns everything that a process writes to standard error into lines of JSON.

Libraries in C, the interpreter and child processes write to standard error without `logging`. So
a pipe replaces the file descriptor; a thread reads the pipe and logs each line that is not JSON
yet. The lines of our loggers do not use the pipe, so that they are not lost if the process dies.
"""

from __future__ import annotations

import faulthandler
import io
import json
import logging
import os
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from types import TracebackType
from typing import Any, TextIO, cast

from app.logs import configure_logging, mask_keys_in_json

log = logging.getLogger("stderr")

STDERR = 2
"""The file descriptor of standard error; `sys.stderr` may be another stream."""
JOIN_TIMEOUT_S = 1.0
"""How long the end waits for the last lines. A child process that still runs may hold the pipe
open."""


class _Lines(io.TextIOBase):
    """A stream to which several threads can write; their lines do not mix.

    A line that cannot be written, because the disk of the log is full, is lost. An exception here
    would itself be logged. It would end the thread that reads the pipe, and then the process would
    stop when the pipe is full.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._lock = threading.Lock()

    def write(self, text: str) -> int:
        content = memoryview(text.encode("utf-8", "backslashreplace"))
        with self._lock, suppress(OSError):
            while content:  # os.write may write a part only
                content = content[os.write(self._descriptor, content) :]
        return len(text)


@contextmanager
def json_stderr() -> Iterator[None]:
    """Write only lines of JSON to standard error within the block; `set_level` sets the level.

    An exception that leaves the block is logged and becomes SystemExit(1).
    """
    real_stderr = os.dup(STDERR)
    lines = _Lines(real_stderr)
    read_end, write_end = os.pipe()
    os.dup2(write_end, STDERR)
    os.close(write_end)
    configure_logging(stream=cast(TextIO, lines))
    log_uncaught()
    # A crash ends the reading thread too, so the crash report must not go through the pipe.
    faulthandler.enable(real_stderr)
    reader = threading.Thread(target=_log_pipe, args=(read_end, lines), daemon=True)
    reader.start()
    try:
        yield
    except Exception as error:
        log.critical("the process ends", exc_info=error)
        raise SystemExit(1) from None
    finally:
        os.dup2(real_stderr, STDERR)
        reader.join(JOIN_TIMEOUT_S)


def log_uncaught() -> None:
    """Log exceptions that no code catches, instead of printing them."""
    sys.excepthook = _log_uncaught
    threading.excepthook = lambda args: _log_uncaught(
        args.exc_type, args.exc_value, args.exc_traceback
    )


def _log_uncaught(
    kind: type[BaseException], error: BaseException | None, trace: TracebackType | None
) -> None:
    if not issubclass(kind, SystemExit | KeyboardInterrupt):
        raised = error if error is not None else kind()
        log.critical("uncaught exception", exc_info=(kind, raised, trace))


def _log_pipe(read_end: int, lines: _Lines) -> None:
    with os.fdopen(read_end, "rb") as pipe:
        for raw in pipe:
            text = raw.decode("utf-8", "backslashreplace").strip()
            entry = _read_json(text)
            if entry is not None:
                lines.write(json.dumps(mask_keys_in_json(entry)) + "\n")
            elif text:
                log.warning("%s", text)


def _read_json(text: str) -> dict[str, Any] | None:
    """The object in a line of JSON, as our child processes write them; None for other lines."""
    if not text.startswith("{"):
        return None
    try:
        entry: dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError):  # too deeply nested JSON is a RecursionError
        return None
    return entry
