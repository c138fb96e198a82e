"""The first check of a request: may this caller call at all?

If no key is required, calls from other sites are refused on every path (see `own_address`). If
keys are required, a call that changes something or has a body needs a valid key before its body is
read. The route decides which role the key needs (`deps`).

It also counts the call (`rates`), and stores when a key was used last.
"""

from __future__ import annotations

import logging
from datetime import datetime

from anyio import CapacityLimiter, to_thread
from fastapi import Request
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.failures.handlers import answer_failure
from app.api.failures.problems import NotReadyYet
from app.api.guard.callers import Caller, address_of, caller_of_session, given_key
from app.api.guard.own_address import refuse_other_pages, refuse_other_sites
from app.api.guard.paths import path_of
from app.api.guard.rates import RateLimits
from app.errors import StorageError
from app.kinedex_error import KinedexError
from app.services.library.library import Library
from app.store import keys
from app.store.database.ids import utc_now
from app.store.keys import KeyRecord
from app.store.sessions import Sessions

log = logging.getLogger(__name__)

COOKIE = "kinedex_session"
"""The cookie that holds the token of a session (`app.store.sessions`)."""
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
        # Only one thread waits for the database's writers, so that no check of a key does.
        self._noting = CapacityLimiter(1)
        self._noted: dict[str, datetime] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 401, 403, 429 or 503 at once, or call the application."""
        if scope["type"] != "http" or path_of(scope) in PROBES:
            await self.app(scope, receive, send)
            return
        try:
            caller, headers = await self._admit(scope)
        except KinedexError as refusal:
            answer = await answer_failure(Request(scope), refusal)
            await answer(scope, receive, send)
            return
        await self.app(scope, receive, _with_headers(send, headers))
        if caller.key is not None:
            await self._note_use(scope, caller.key)

    async def _admit(self, scope: Scope) -> tuple[Caller, dict[str, str]]:
        """The caller, and headers of the answer. Raises the refusal of the call."""
        library: Library | None = scope["app"].state.library
        if library is None:
            raise NotReadyYet
        limits: RateLimits = scope["app"].state.limits
        sent, address = given_key(Headers(scope=scope)), address_of(scope)
        token = "" if sent else Request(scope).cookies.get(COOKIE, "")
        sessions: Sessions = scope["app"].state.sessions

        def find() -> tuple[Caller, dict[str, str]]:
            key_id = sessions.key_of(token)  # which was right once, so that it is no try
            if key_id:
                caller = caller_of_session(library, key_id, address)
            else:
                caller = limits.identify(sent, address)
            # For the log, which also names the key of a call that is refused.
            scope.setdefault("state", {})["caller"] = caller
            return caller, limits.take(caller)

        caller, headers = await to_thread.run_sync(find, limiter=self._threads)
        if caller.is_free:
            refuse_other_sites(scope, library.settings.cors_origins)
        elif caller.has_key and not sent:
            refuse_other_pages(scope)
        call = (scope["method"], path_of(scope))
        if scope["method"] not in WITHOUT_BODY and call != SIGN_IN:
            caller.require_key()
        return caller, headers

    async def _note_use(self, scope: Scope, key: KeyRecord) -> None:
        """Store the time of the call as the last use of its key, if it is due."""
        now = utc_now()
        noted = self._noted.get(key.id)
        if not key.is_use_due(now) or (noted is not None and now - noted < keys.USE_INTERVAL):
            return
        self._noted[key.id] = now
        library: Library = scope["app"].state.library

        def note() -> None:
            with library.store.write() as tx:
                keys.note_use(tx, key.id, now)

        try:
            await to_thread.run_sync(note, limiter=self._noting)
        except StorageError as problem:
            log.warning("the last use of a key was not stored: %s", problem.detail)


def _with_headers(send: Send, headers: dict[str, str]) -> Send:
    if not headers:
        return send

    async def send_with_headers(message: Message) -> None:
        if message["type"] == "http.response.start":
            MutableHeaders(scope=message).update(headers)
        await send(message)

    return send_with_headers
