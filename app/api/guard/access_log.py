"""The log line of a request, and the id that it carries."""

from __future__ import annotations

import logging
import re
import uuid

from starlette.datastructures import Headers
from starlette.types import Scope

from app.api.guard.methods import METHODS
from app.logs import mask_keys

log = logging.getLogger("app.api.access")

_ACCEPTABLE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}", re.ASCII)
_MAYBE_SECRET = re.compile(r"(?i)k[._-]?x[._-]|[a-z0-9_-]{43}")
"""Any trace of an API key, or its secret part alone, which is so long."""
_HEXADECIMAL = re.compile(r"[0-9A-Fa-f.-]+")
"""Ids of traces may be longer than a secret part, and are never one."""
_PERSON = re.compile(r"(/persons/).+", re.DOTALL)
LONGEST_PATH = 300
"""Characters of a path that are logged."""


def identity_of(scope: Scope) -> str:
    """The client's X-Request-Id, or a new one where that cannot be used, or may hold a key."""
    given = Headers(scope=scope).get("x-request-id", "")
    if not _ACCEPTABLE_ID.fullmatch(given):
        return uuid.uuid4().hex
    if _MAYBE_SECRET.search(given) and not _HEXADECIMAL.fullmatch(given):
        return uuid.uuid4().hex
    return given


def log_request(scope: Scope, status: int, seconds: float) -> None:
    """One line. The query string is left out: a person's name may stand in it, and a key too."""
    fields = {
        "method": scope["method"] if scope["method"] in METHODS else "other",
        "path": _shown(scope["path"]),
        "status": status,
        "ms": round(seconds * 1000, 1),
    }
    log.info("request", extra={"fields": fields})


def _shown(path: str) -> str:
    # A person's name is not to be kept, least of all of one who is forgotten.
    return mask_keys(_PERSON.sub(r"\1{name}", path))[:LONGEST_PATH]
