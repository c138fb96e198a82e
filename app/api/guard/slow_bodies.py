"""A minimum rate for bodies, and a limit on the bodies that are received at once.

There are three kinds of slots, so that no kind waits for another: forms to be stored (clips,
imports), forms with a query (searches, recognition), and all other bodies, which are small. A body
that has arrived completely when the call reads it needs no slot.

A refusal is an HTTPException, because FastAPI's reader of bodies passes only those on.
"""

from __future__ import annotations

import asyncio
from contextlib import ExitStack

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.failures.problems import RETRY_AFTER_SECONDS, TooBusy
from app.api.guard.arrival import Arrival, TooSlow
from app.api.guard.media import FORM, media_type
from app.api.guard.paths import path_of
from app.api.guard.slots import Slots
from app.config import Settings

STORED_FORMS = frozenset({"/v1/clips", "/v1/imports"})
"""The calls whose forms are stored. The forms of all other calls are queries."""
MAX_SMALL_BODIES = 64
"""JSON bodies received at once."""
MOMENT_SECONDS = 0.5
"""A body that arrives completely within this time needs no slot."""


class SlowBodies:
    """ASGI middleware: it answers 408 to a slow body, 503 if too many bodies are received."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app = app
        self._stored = Slots(settings.max_concurrent_uploads)
        self._queries = Slots(settings.max_concurrent_uploads)
        self._small = Slots(MAX_SMALL_BODIES)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Watch the body of a request until it has arrived."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        with ExitStack() as slot:
            body = _Body(receive, send, self._slots(scope), slot)
            await self.app(scope, body.receive, body.send)

    def _slots(self, scope: Scope) -> Slots:
        if media_type(Headers(scope=scope)) != FORM:
            return self._small
        path = path_of(scope)
        return self._stored if path in STORED_FORMS else self._queries


class _Body:
    """The body of one request. It also notes whether the answer has begun."""

    def __init__(self, receive: Receive, send: Send, slots: Slots, slot: ExitStack) -> None:
        self._receive, self._send = receive, send
        self._slots, self._slot = slots, slot
        self._arrival = Arrival()
        self._has_slot = self._is_whole = self._is_answered = False

    async def send(self, message: Message) -> None:
        self._is_answered = True
        await self._send(message)

    async def receive(self) -> Message:
        if self._is_whole:
            return await self._receive()
        try:
            message = await self._next()
        except TooSlow:
            # The answer has begun, so a problem cannot be sent any more.
            if self._is_answered:
                return {"type": "http.disconnect"}
            raise HTTPException(408, "The body came too slowly.", {"Connection": "close"}) from None
        if not message.get("more_body", False):
            self._is_whole = True
            self._slot.close()
        return message

    async def _next(self) -> Message:
        if self._has_slot:
            return await self._arrival.next(self._receive)
        message = await self._at_once()
        if message is not None and not message.get("more_body", False):
            return message
        self._take_slot()
        if message is None:
            return await self._arrival.next(self._receive)
        self._arrival.came(len(message["body"]))
        return message

    async def _at_once(self) -> Message | None:
        """Return the first piece, or None if it does not come within MOMENT_SECONDS."""
        try:
            async with asyncio.timeout(MOMENT_SECONDS):
                return await self._receive()
        except TimeoutError:
            return None

    def _take_slot(self) -> None:
        try:
            self._slot.enter_context(self._slots.one(self._arrival))
        except TooBusy as busy:
            headers = {"Retry-After": RETRY_AFTER_SECONDS, "Connection": "close"}
            raise HTTPException(503, busy.detail, headers) from None
        self._has_slot = True
