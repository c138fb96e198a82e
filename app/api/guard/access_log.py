"""The log line of a request, and the request's id."""

from __future__ import annotations

import logging
import re
import uuid

from starlette.datastructures import Headers
from starlette.types import Scope

from app.api.guard.callers import Caller, address_of
from app.api.guard.methods import METHODS
from app.logs import mask_keys

log = logging.getLogger("app.api.access")

_ACCEPTABLE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}", re.ASCII)
_MAYBE_SECRET = re.compile(r"(?i)k[._-]?x[._-]|[a-z0-9_-]{43}")
"""A trace of an API key, or a text as long as the secret part of one (43 characters)."""
_HEXADECIMAL = re.compile(r"[0-9A-Fa-f.-]+")
"""A trace id may be longer than the secret part, but is hexadecimal: it is never a key."""
_PERSON = re.compile(r"(/persons/).+", re.DOTALL)
MAX_PATH_LENGTH = 300
"""Logged characters of a path."""


def identity_of(scope: Scope) -> str:
    """Return the client's X-Request-Id, or a new id if that one is malformed or may hold a key."""
    given = Headers(scope=scope).get("x-request-id", "")
    if not _ACCEPTABLE_ID.fullmatch(given):
        return uuid.uuid4().hex
    if _MAYBE_SECRET.search(given) and not _HEXADECIMAL.fullmatch(given):
        return uuid.uuid4().hex
    return given


def log_request(scope: Scope, status: int, seconds: float) -> None:
    """Log one line, without the query string: it may hold a person's name or a key.

    client: the address of the client; behind a proxy that is not trusted, the proxy's. key_id: the
    public id of the API key, only for calls with a valid key; the key itself is never logged.
    """
    fields = {
        "client": address_of(scope),
        "method": scope["method"] if scope["method"] in METHODS else "other",
        "path": _shown(scope["path"]),
        "status": status,
        "ms": round(seconds * 1000, 1),
    }
    caller: Caller | None = scope.get("state", {}).get("caller")
    if caller is not None and caller.key_id is not None:
        fields["key_id"] = caller.key_id
    log.info("request", extra={"fields": fields})


def _shown(path: str) -> str:
    # The log outlives DELETE /v1/persons/{name}, so it must not hold the name.
    return mask_keys(_PERSON.sub(r"\1{name}", path))[:MAX_PATH_LENGTH]
