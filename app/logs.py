"""Logs as JSON lines, carrying the request's and the job's id.

The callers log names, ids, counts and durations, never the content of a file. If an API key gets
into a line, it is replaced by KEY_MASK. Warnings of Python become lines too. This module uses the
standard library only, so that the API and the worker share it.
"""

from __future__ import annotations

import json
import logging
import re
import sys
from contextvars import ContextVar
from datetime import UTC, datetime
from typing import Any, TextIO
from urllib.parse import unquote

request_id: ContextVar[str | None] = ContextVar("request_id", default=None)
"""The id of the current request; None outside of a request."""

job_id: ContextVar[str | None] = ContextVar("job_id", default=None)
"""The id of the current job; None outside of a job."""


KEY = re.compile(r"(?i)kx_[a-z0-9_-]{8,}")
"""An API key (`app.store.keys`) or its beginning, in upper or lower case."""
_TOKEN = re.compile(r"[A-Za-z0-9_%-]{11,}")
"""A word that may be a key, or a key that is percent-encoded once or several times."""
MAX_ENCODINGS = 8
"""How often a key may be percent-encoded. No program decodes that often."""
KEY_MASK = "[key]"


def mask_keys(text: str) -> str:
    """`text`, in which KEY_MASK replaces every word that holds an API key."""
    if "%" not in text and not KEY.search(text):
        return text
    return _TOKEN.sub(lambda match: KEY_MASK if _holds_key(match[0]) else match[0], text)


def _holds_key(token: str) -> bool:
    for _ in range(MAX_ENCODINGS):
        if "%" not in token:
            break
        token = unquote(token)
    return bool(KEY.search(token))


def mask_keys_in_json(value: Any) -> Any:
    """A JSON value in which `mask_keys` was applied to every text, names of members included."""
    if isinstance(value, str):
        return mask_keys(value)
    if isinstance(value, dict):
        return {mask_keys_in_json(key): mask_keys_in_json(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [mask_keys_in_json(each) for each in value]
    return value


class JsonFormatter(logging.Formatter):
    """Each line is one JSON object: time, level, logger, message and ids.

    A caller adds members of its own by `extra={"fields": {...}}`.
    """

    def format(self, record: logging.LogRecord) -> str:
        """The record as one line of JSON."""
        line: dict[str, Any] = {
            "time": datetime.fromtimestamp(record.created, UTC).isoformat(timespec="milliseconds"),
            "level": record.levelname.lower(),
            "logger": record.name,
            "message": record.getMessage(),
        }
        ids = {"request_id": request_id.get(), "job_id": job_id.get()}
        line |= {name: value for name, value in ids.items() if value is not None}
        line |= getattr(record, "fields", {})
        if record.exc_info:
            line["exception"] = self.formatException(record.exc_info)
        # `dumps` writes ASCII only: some readers of lines also end a line at U+0085.
        return json.dumps(mask_keys_in_json(line), default=lambda value: mask_keys(str(value)))


def configure_logging(level: str = "INFO", stream: TextIO | None = None) -> None:
    """Send the lines of all loggers to `stream` (standard error) as JSON; remove other handlers.

    The access log of uvicorn is off, because the API writes its own line for each request.
    Warnings of Python become lines of the logger `py.warnings`.
    """
    handler = logging.StreamHandler(stream or sys.stderr)
    handler.setFormatter(JsonFormatter())
    root = logging.getLogger()
    root.handlers = [handler]
    set_level(level)
    for name in ("uvicorn", "uvicorn.error", "uvicorn.access"):
        logger = logging.getLogger(name)
        logger.handlers = []
        logger.propagate = True
    for name in ("uvicorn.access", "alembic"):
        logging.getLogger(name).setLevel(logging.WARNING)
    logging.captureWarnings(True)


def set_level(level: str) -> None:
    """Set the lowest severity that is logged from now on."""
    logging.getLogger().setLevel(level)


def level_of_process() -> str:
    """The lowest severity that this process logs; its child processes are given the same."""
    return logging.getLevelName(logging.getLogger().getEffectiveLevel())
