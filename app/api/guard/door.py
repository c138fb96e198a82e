"""Before anything else is done for a request: may this caller call at all?

Where no key is asked for, other sites are refused on every path (see `own_address`). Where keys
are asked for, a call that changes something, or that has a body, needs a valid one before any of
its body is read; which role it needs is up to the route (`deps`).
"""

from __future__ import annotations

from anyio import CapacityLimiter, to_thread
from fastapi import Request
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.handlers import answer_failure
from app.api.failures.problems import NotReadyYet
from app.api.guard.callers import Caller, given_key, who_calls
from app.api.guard.own_address import refuse_other_pages, refuse_other_sites
from app.api.guard.paths import path_of
from app.api.guard.sessions import COOKIE, Sessions
from app.errors import KinedexError
from app.services.library.library import Library

PROBES = frozenset({"/livez", "/readyz"})
"""Whoever runs the service asks these, by any name; they hold nothing of the library."""
SIGN_IN = ("POST", "/v1/session")
"""The only call whose body is read without a key: the key is in it."""
WITHOUT_BODY = frozenset({"GET", "HEAD", "OPTIONS"})
THREADS = 8
"""For looking keys up, so that calls that take long do not hold this up."""


class Door:
    """ASGI middleware; `request.state.caller` is the Caller afterwards."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._threads = CapacityLimiter(THREADS)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 401, 403 or 503 at once, or pass the request on."""
        if scope["type"] != "http" or path_of(scope) in PROBES:
            await self.app(scope, receive, send)
            return
        try:
            caller = await self._admit(scope)
        except KinedexError as refusal:
            answer = await answer_failure(Request(scope), refusal)
            await answer(scope, receive, send)
            return
        scope.setdefault("state", {})["caller"] = caller
        await self.app(scope, receive, send)

    async def _admit(self, scope: Scope) -> Caller:
        library: Library | None = scope["app"].state.library
        if library is None:
            raise NotReadyYet
        sent = given_key(Headers(scope=scope))
        key = sent or _key_of_session(scope)
        caller = await to_thread.run_sync(who_calls, library, key, limiter=self._threads)
        if caller.is_free:
            refuse_other_sites(scope)
        elif key and not sent:
            refuse_other_pages(scope)
        call = (scope["method"], path_of(scope))
        if scope["method"] not in WITHOUT_BODY and call != SIGN_IN:
            caller.require_key()
        return caller


def _key_of_session(scope: Scope) -> str:
    sessions: Sessions = scope["app"].state.sessions
    return sessions.key_of(Request(scope).cookies.get(COOKIE, ""))
