"""Refuses searches at once, before their bodies are read, while too many wait.

A call is refused at its gate in any case (`app.api.guard.gates`), but only after its key was
checked and its body was read: under overload, all this work for calls that get no answer takes the
time of those that get one.
"""

from __future__ import annotations

from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.problems import RETRY_AFTER_SECONDS, problem_of
from app.api.failures.response import respond
from app.api.guard.gates import Gates
from app.api.guard.paths import path_of

SHED = frozenset(
    {
        *("/v1/search", "/v1/search/motion", "/v1/search/words", "/v1/search/pose"),
        "/v1/recognize",
    }
)
"""Paths whose POST is a heavy call (`app.api.guard.admission`)."""


class Shedding:
    """ASGI middleware: it answers 503 with Retry-After to a call that its gate would refuse."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the application, unless the queue for heavy calls is full."""
        if scope["type"] == "http" and scope["method"] == "POST" and path_of(scope) in SHED:
            gates: Gates = scope["app"].state.gates
            if gates.heavy.is_full:
                refused = problem_of(gates.heavy.refusal())
                answer = respond(refused, {"Retry-After": RETRY_AFTER_SECONDS})
                await answer(scope, receive, send)
                return
        await self.app(scope, receive, send)
