"""Refuses unknown HTTP methods before the metrics count the request.

A client may send any word as its method. Each word would become a label of the metrics and stay
there.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.problems import UnknownMethod, problem_of
from app.api.failures.response import respond

METHODS = frozenset(
    {"CONNECT", "DELETE", "GET", "HEAD", "OPTIONS", "PATCH", "POST", "PUT", "QUERY", "TRACE"}
)
"""The methods of RFC 9110, of RFC 5789 (PATCH), and QUERY of the IETF's HTTP working group."""


class KnownMethods:
    """ASGI middleware: it answers 501 to a method that is not in METHODS."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the application if the method is known."""
        if scope["type"] != "http" or scope["method"] in METHODS:
            await self.app(scope, receive, send)
            return
        detail = f"Known methods are {', '.join(sorted(METHODS))}."
        await respond(problem_of(UnknownMethod(detail)))(scope, receive, send)
