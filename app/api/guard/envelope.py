"""The outermost middleware: request ids, log lines, security headers, unexpected exceptions."""

from __future__ import annotations

import time

from starlette.datastructures import MutableHeaders
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.failures.handlers import answer_unexpected
from app.api.failures.problems import CLIENT_LEFT
from app.api.guard.access_log import identity_of, log_request
from app.logs import request_id

SECURITY_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Content-Security-Policy": "default-src 'none'; frame-ancestors 'none'; base-uri 'none'",
}
"""Headers of every answer. An answer that needs another policy sets its own."""

SUCCESSES = range(200, 300)
"""Statuses of answers that get the headers in `request.state.answer_headers`."""


class CutOff(Exception):
    """An answer ends early, and its connection is closed. status: the status for the log."""

    def __init__(self, status: int) -> None:
        self.status = status


class Envelope:
    """ASGI middleware. It wraps all other middlewares of Kinedex."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Give the request an id, and log the request when it has been answered."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        identity = identity_of(scope)
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
                headers = MutableHeaders(scope=message)
                if status in SUCCESSES:
                    headers.update(scope.get("state", {}).get("answer_headers", {}))
                _complete(headers, identity)
            await send(message)

        try:
            await self.app(scope, receive, send_with_headers)
        except ClientDisconnect:
            status = CLIENT_LEFT
        except CutOff as cut:
            # The server closes the connection, so that the client sees an unfinished answer.
            status = cut.status
        except Exception as error:  # noqa: BLE001 - every other exception becomes a 500
            response = answer_unexpected(error)
            if not status:  # else the answer has begun, and a second one cannot be sent
                await response(scope, receive, send_with_headers)
        finally:
            log_request(scope, status, time.perf_counter() - started)


def _complete(headers: MutableHeaders, identity: str) -> None:
    headers["X-Request-Id"] = identity
    for name, value in SECURITY_HEADERS.items():
        headers.setdefault(name, value)
