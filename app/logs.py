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
"""The id of the request that is being answered, None outside of one."""

job_id: ContextVar[str | None] = ContextVar("job_id", default=None)
"""The id of the job that is being done, None outside of one."""


KEY = re.compile(r"(?i)kx_[a-z0-9_-]{8,}")
"""An API key (`app.store.keys`), or the greater part of one; also in another case."""
_TOKEN = re.compile(r"[A-Za-z0-9_%-]{11,}")
"""What may be a key whose characters are percent-encoded, once or several times."""
MAX_ENCODINGS = 8
"""Times that a key may be percent-encoded; no program decodes so often."""
KEY_MASK = "[key]"


def mask_keys(text: str) -> str:
    """`text` with KEY_MASK in the place of every word that holds an API key."""
    if "%" not in text and not KEY.search(text):
        return text
    return _TOKEN.sub(lambda found: KEY_MASK if _holds_key(found[0]) else found[0], text)


def _holds_key(token: str) -> bool:
    for _ in range(MAX_ENCODINGS):
        if "%" not in token:
            break
        token = unquote(token)
    return bool(KEY.search(token))


def mask_keys_in_json(value: Any) -> Any:
    """A value of JSON in which no text holds an API key."""
    if isinstance(value, str):
        return mask_keys(value)
    if isinstance(value, dict):
        return {mask_keys_in_json(key): mask_keys_in_json(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [mask_keys_in_json(each) for each in value]
    return value


class JsonFormatter(logging.Formatter):
    """One JSON object a line: time, level, logger, message, ids, `extra={"fields": {...}}`."""

    def format(self, record: logging.LogRecord) -> str:
        """The record as a line."""
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
        # ASCII: some readers end lines at U+0085 too.
        return json.dumps(mask_keys_in_json(line), default=lambda value: mask_keys(str(value)))


def configure_logging(level: str = "INFO", stream: TextIO | None = None) -> None:
    """Send every logger's lines to `stream` (standard error) as JSON; replaces other handlers.

    uvicorn's access log is silenced: the API writes its own line a request. Warnings become
    lines of the logger `py.warnings`.
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
    """The least severity that is logged from now on."""
    logging.getLogger().setLevel(level)


def level_of_process() -> str:
    """The level that this process logs at, for its children."""
    return logging.getLevelName(logging.getLogger().getEffectiveLevel())
