"""The first check of a request: may this caller call at all?

If no key is required, calls from other sites are refused on every path (see `own_address`). If
keys are required, a call that changes something or has a body needs a valid key before its body is
read. The route decides which role the key needs (`deps`).
"""

from __future__ import annotations

from anyio import CapacityLimiter, to_thread
from fastapi import Request
from starlette.datastructures import Headers
from starlette.types import ASGIApp, Receive, Scope, Send

from app.api.failures.handlers import answer_failure
from app.api.failures.problems import NotReadyYet
from app.api.guard.callers import find_caller, given_key
from app.api.guard.own_address import refuse_other_pages, refuse_other_sites
from app.api.guard.paths import path_of
from app.api.guard.sessions import COOKIE, Sessions
from app.kinedex_error import KinedexError
from app.services.library.library import Library

SIGN_IN = ("POST", "/v1/session")
"""The only call whose body is read without a key: the key is in it."""
PROBES = frozenset({"/livez", "/readyz"})
"""Monitoring calls these paths under any host name. They show nothing of the library."""
WITHOUT_BODY = frozenset({"GET", "HEAD", "OPTIONS"})
"""Methods that have no body and change nothing."""
THREADS = 8
"""Threads only for looking up keys, so that long calls do not delay this check."""


class AccessCheck:
    """ASGI middleware. It puts the Caller into `request.state.caller`."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._threads = CapacityLimiter(THREADS)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 401, 403 or 503 at once, or call the application."""
        if scope["type"] != "http" or path_of(scope) in PROBES:
            await self.app(scope, receive, send)
            return
        try:
            await self._admit(scope)
        except KinedexError as refusal:
            answer = await answer_failure(Request(scope), refusal)
            await answer(scope, receive, send)
            return
        await self.app(scope, receive, send)

    async def _admit(self, scope: Scope) -> None:
        library: Library | None = scope["app"].state.library
        if library is None:
            raise NotReadyYet
        sent = given_key(Headers(scope=scope))
        key = sent or _key_of_session(scope)
        caller = await to_thread.run_sync(find_caller, library, key, limiter=self._threads)
        # For the log, which also names the key of a call that is refused.
        scope.setdefault("state", {})["caller"] = caller
        if caller.is_free:
            refuse_other_sites(scope, library.settings.cors_origins)
        elif key and not sent:
            refuse_other_pages(scope)
        call = (scope["method"], path_of(scope))
        if scope["method"] not in WITHOUT_BODY and call != SIGN_IN:
            caller.require_key()


def _key_of_session(scope: Scope) -> str:
    sessions: Sessions = scope["app"].state.sessions
    return sessions.key_of(Request(scope).cookies.get(COOKIE, ""))
