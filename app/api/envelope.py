"""Around every request: its id, its log line, security headers, and the last net for failures."""

from __future__ import annotations

import logging
import re
import time
import uuid

from starlette.datastructures import Headers, MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.errors import answer_unexpected
from app.api.pieces import CutOff
from app.api.problems import CLIENT_LEFT
from app.logs import request_id
from app.store import keys

log = logging.getLogger("app.api.access")

_ACCEPTABLE_ID = re.compile(r"[A-Za-z0-9._-]{1,64}")
SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'; base-uri 'none'",
}
"""Sent with every answer; an answer that needs another policy sets its own."""


class Envelope:
    """ASGI middleware, the outermost one of ours."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Give the request an id, log it when it has been answered."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        identity = _identity(scope)
        mark = request_id.set(identity)
        try:
            await self._answer(scope, receive, send, identity)
        finally:
            request_id.reset(mark)

    async def _answer(self, scope: Scope, receive: Receive, send: Send, identity: str) -> None:
        started = time.perf_counter()
        status = 0

        async def send_with_headers(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                _complete(MutableHeaders(scope=message), identity)
            await send(message)

        try:
            await self.app(scope, receive, send_with_headers)
        except ClientDisconnect:
            status = CLIENT_LEFT
        except CutOff as cut:
            # The server closes the connection, so that the client sees an unfinished answer.
            status = cut.status
        except Exception as error:  # noqa: BLE001 - the last net: nothing may pass it
            response = answer_unexpected(error)
            if not status:
                await response(scope, receive, send_with_headers)
        finally:
            _log_line(scope, status, time.perf_counter() - started)


def _identity(scope: Scope) -> str:
    given = Headers(scope=scope).get("x-request-id", "")
    # Whoever sends a key in the wrong header must not find it in the log.
    is_key = given.startswith(f"{keys.PREFIX}_")
    return given if _ACCEPTABLE_ID.fullmatch(given) and not is_key else uuid.uuid4().hex


def _complete(headers: MutableHeaders, identity: str) -> None:
    headers["X-Request-Id"] = identity
    for name, value in SECURITY_HEADERS.items():
        headers.setdefault(name, value)


def _log_line(scope: Scope, status: int, seconds: float) -> None:
    # A person's name is not to be kept, least of all of one who is forgotten: it may stand in the
    # query string, which is left out, and in the path of `/v1/persons/{name}`.
    name = scope.get("path_params", {}).get("name")
    path = scope["path"] if name is None else scope["path"].removesuffix(name) + "{name}"
    fields = {
        "method": scope["method"],
        "path": path,
        "status": status,
        "ms": round(seconds * 1000, 1),
    }
    log.info("request", extra={"fields": fields})
