"""HTTP methods that no route has are refused before they are counted.

Any word may stand where the method stands: as a label of the metrics, each would add lines to
them for good.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.problems import UnknownMethod, problem_of
from app.api.failures.response import respond

METHODS = frozenset(
    {"CONNECT", "DELETE", "GET", "HEAD", "OPTIONS", "PATCH", "POST", "PUT", "TRACE"}
)
"""Those of RFC 9110 and RFC 5789."""


class KnownMethods:
    """ASGI middleware: answers 501 to a method that is none of METHODS."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on what has a known method."""
        if scope["type"] != "http" or scope["method"] in METHODS:
            await self.app(scope, receive, send)
            return
        detail = f"Known methods are {', '.join(sorted(METHODS))}."
        await respond(problem_of(UnknownMethod(detail)))(scope, receive, send)
