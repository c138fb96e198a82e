"""`Idempotency-Key`: a call with the same key takes effect once, however often it is sent.

The key belongs to the caller, the path and the query. For 24 hours a repeated call gets the stored
answer, with the header `Idempotency-Replayed`. The same key with another body is refused (422), and
so is a call that is still running (409). A call that failed without a change can be made again.
`app.store.keyed_calls` says what happens if the process is killed.
"""

from __future__ import annotations

import hashlib
import logging
import re
from collections.abc import Callable
from typing import TypeVar

from anyio import CancelScope, CapacityLimiter, to_thread
from fastapi import Request, Response
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.failures.handlers import answer_failure
from app.api.failures.problems import problem_of_http
from app.api.failures.response import respond
from app.api.guard.callers import Caller
from app.api.guard.content import ContentDigest
from app.api.guard.paths import path_of
from app.errors import BadField, IdempotencyKeyReused, StorageError
from app.kinedex_error import KinedexError, Place
from app.services.library.library import Library
from app.store import keyed_calls
from app.store.database.engine import Tx
from app.store.jobs import owners
from app.store.keyed_calls import Answer, Try

log = logging.getLogger(__name__)

HEADER = "Idempotency-Key"
REPLAYED = {"Idempotency-Replayed": "true"}
READING = ("/v1/search", "/v1/recognize", "/v1/session")
"""Calls by POST that change nothing stored, so that a key changes nothing either."""
REPEATABLE = frozenset({"/v1/clips", "/v1/synthesize"})
"""Calls that find what an earlier call stored by its content."""
MAX_BODY_BYTES = 2**20
"""A larger answer is not stored."""
THREADS = 4
_KEY = re.compile(r"[\x21-\x7e]{1,255}", re.ASCII)
_Result = TypeVar("_Result")


def takes_key(method: str, path: str) -> bool:
    """Whether calls of this path consider the header."""
    return method.upper() == "POST" and path.startswith("/v1/") and not path.startswith(READING)


class Idempotency:
    """ASGI middleware. It runs a call with a key, or answers it from the store."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._owner = owners.new_owner("api")
        self._threads = CapacityLimiter(THREADS)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the application, at most once for each key."""
        # The server may begin a request in the context of an earlier request of the connection:
        # asyncio keeps the context in which reading was resumed.
        with keyed_calls.running(None):
            key = Headers(scope=scope).get(HEADER.lower()) if scope["type"] == "http" else None
            if key is None or not takes_key(scope["method"], path_of(scope)):
                await self.app(scope, receive, send)
            else:
                await self._call(key, scope, receive, send)

    async def _call(self, key: str, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            begun = await self._begin(scope, key)
            if isinstance(begun, Answer):
                await self._repeat(begun, scope, receive, send)
                return
        except KinedexError as refusal:
            answer = await answer_failure(Request(scope), refusal)
            await answer(scope, receive, send)
            return
        await self._run(begun, scope, receive, send)

    async def _begin(self, scope: Scope, key: str) -> Try | Answer:
        if not _KEY.fullmatch(key):
            message = "must be 1 to 255 printable ASCII characters without spaces"
            raise BadField("A header is wrong.", places=[Place(f"header.{HEADER}", message)])
        caller: Caller = scope["state"]["caller"]
        path, query = path_of(scope), scope["query_string"].decode("latin-1")
        named = "\n".join((caller.key_id or "", path, query, key))
        digest = hashlib.sha256(named.encode()).hexdigest()
        can_repeat = path in REPEATABLE

        def begin(tx: Tx) -> Try | Answer:
            return keyed_calls.begin(tx, digest, self._owner, can_repeat=can_repeat)

        return await self._write(scope, begin)

    async def _repeat(self, stored: Answer, scope: Scope, receive: Receive, send: Send) -> None:
        digest = ContentDigest(Headers(scope=scope))
        more = True
        while more:
            try:
                message = await receive()
            except HTTPException as refusal:  # the body is too large, or comes too slowly
                detail = problem_of_http(refusal.status_code, refusal.detail)
                await respond(detail, refusal.headers)(scope, receive, send)
                return
            digest.update(message.get("body", b""))
            more = message["type"] == "http.request" and message.get("more_body", False)
        if digest.hexdigest() != stored.content_sha256:
            raise IdempotencyKeyReused(places=[Place(f"header.{HEADER}", "use another key")])
        answer = Response(stored.body, stored.status, REPLAYED, stored.media_type)
        await answer(scope, receive, send)

    async def _run(self, this: Try, scope: Scope, receive: Receive, send: Send) -> None:
        call = _Call(scope, receive, send)
        try:
            with keyed_calls.running(this):
                await self.app(scope, call.receive, call.send)
        finally:
            # Also if this task is cancelled: else nobody could make the call again.
            with CancelScope(shield=True):
                try:
                    await self._write(scope, lambda tx: _settle(tx, this, call))
                except StorageError as problem:
                    log.warning("the answer of a call was not stored: %s", problem.detail)
        await call.pass_on()

    async def _write(self, scope: Scope, work: Callable[[Tx], _Result]) -> _Result:
        library: Library = scope["app"].state.library

        def run() -> _Result:
            with library.store.write() as tx:
                return work(tx)

        return await to_thread.run_sync(run, limiter=self._threads)


def _settle(tx: Tx, this: Try, call: _Call) -> None:
    answer = call.answer()
    if answer is not None and answer.status < 400:
        keyed_calls.finish(tx, this, answer)
    else:
        is_repeatable = path_of(call.scope) in REPEATABLE
        keyed_calls.give_up(tx, this, is_repeatable=is_repeatable)


class _Call:
    """A call that runs: what it sends, and its answer, which waits until it is stored."""

    def __init__(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.scope = scope
        self._receive, self._send = receive, send
        self._digest = ContentDigest(Headers(scope=scope))
        self._messages: list[Message] = []
        self._size = 0
        self._is_whole = self._is_passed_on = False

    async def receive(self) -> Message:
        """The next message of the client."""
        message = await self._receive()
        self._digest.update(message.get("body", b""))
        return message

    async def send(self, message: Message) -> None:
        """Keep a message of the answer, or pass it on if the answer is too large."""
        if self._is_passed_on:
            await self._send(message)
            return
        self._messages.append(message)
        if message["type"] == "http.response.body":
            self._size += len(message.get("body", b""))
            self._is_whole = not message.get("more_body", False)
        if self._size > MAX_BODY_BYTES:
            await self.pass_on()

    async def pass_on(self) -> None:
        """Send what was kept."""
        self._is_passed_on = True
        for message in self._messages:
            await self._send(message)
        self._messages = []

    def answer(self) -> Answer | None:
        """The answer, None if it is not whole or too large."""
        if self._is_passed_on or not self._is_whole:
            return None
        start, *bodies = self._messages
        body = b"".join(message.get("body", b"") for message in bodies)
        media_type = Headers(raw=start["headers"]).get("content-type")
        return Answer(self._digest.hexdigest(), start["status"], media_type, body)
