"""Whatever a process writes to standard error becomes lines of JSON.

Libraries in C, the interpreter itself and child processes write there past `logging`. So the file
descriptor becomes a pipe; a thread reads it and logs each line that is not JSON already. Our own
lines go past the pipe, so that they are not lost when the process dies.
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
"""Its file descriptor, whatever `sys.stderr` is."""
END_SECONDS = 1.0
"""For the last lines at the end; a child that lives on may hold the pipe open."""


class _Lines(io.TextIOBase):
    """A stream into which threads write whole lines, one after the other.

    A line that cannot be written (the disk that holds the log is full) is lost. An exception
    would be logged in its turn, end the thread that reads the pipe, and so stop the process.
    """

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor
        self._turn = threading.Lock()

    def write(self, text: str) -> int:
        content = memoryview(text.encode("utf-8", "backslashreplace"))
        with self._turn, suppress(OSError):
            while content:
                content = content[os.write(self._descriptor, content) :]
        return len(text)


@contextmanager
def json_stderr() -> Iterator[None]:
    """Let nothing but lines of JSON reach standard error within the block; see `set_level`."""
    outside = os.dup(STDERR)
    lines = _Lines(outside)
    reading, writing = os.pipe()
    os.dup2(writing, STDERR)
    os.close(writing)
    configure_logging(stream=cast(TextIO, lines))
    log_uncaught()
    faulthandler.enable(outside)
    reader = threading.Thread(target=_pass_on, args=(reading, lines), daemon=True)
    reader.start()
    try:
        yield
    except Exception as error:
        log.critical("the process ends", exc_info=error)
        raise SystemExit(1) from None
    finally:
        os.dup2(outside, STDERR)
        reader.join(END_SECONDS)


def log_uncaught() -> None:
    """Let exceptions that nobody caught be logged, not printed."""
    sys.excepthook = _log_uncaught
    threading.excepthook = lambda told: _log_uncaught(
        told.exc_type, told.exc_value, told.exc_traceback
    )


def _log_uncaught(
    kind: type[BaseException], error: BaseException | None, trace: TracebackType | None
) -> None:
    if not issubclass(kind, SystemExit | KeyboardInterrupt):
        told = error if error is not None else kind()
        log.critical("uncaught exception", exc_info=(kind, told, trace))


def _pass_on(reading: int, lines: _Lines) -> None:
    with os.fdopen(reading, "rb") as pipe:
        for raw in pipe:
            text = raw.decode("utf-8", "backslashreplace").strip()
            told = _read_json(text)
            if told is not None:
                lines.write(json.dumps(mask_keys_in_json(told)) + "\n")
            elif text:
                log.warning("%s", text)


def _read_json(text: str) -> dict[str, Any] | None:
    """A line that is an object of JSON already, as our children write them."""
    if not text.startswith("{"):
        return None
    try:
        told: dict[str, Any] = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return told
