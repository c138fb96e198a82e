"""A limit on the size of a request's body, held by Content-Length and while streaming."""

from __future__ import annotations

from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from app.api.failures.problems import problem_of
from app.api.failures.response import respond
from app.api.guard.media import FORM, media_type
from app.api.guard.paths import path_of
from app.config import Settings
from app.errors import TooLarge

FORM_BYTES = 2**20
"""What a form may hold beside its file."""
JSON_BYTES = 2**20
"""The largest body that is no form with files: while JSON is parsed, nothing else is answered."""
MOST_DRAINED = 16 * 2**20
"""Bytes read and dropped after a refusal: many clients send all before they listen."""


class BodyLimit:
    """ASGI middleware: bodies over the limit of their path are refused with 413."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app = app
        self._limits = {
            "/v1/imports": settings.max_archive_bytes + FORM_BYTES,
            "/v1/clips": settings.max_upload_bytes + FORM_BYTES,
            "/v1/search/motion": settings.max_upload_bytes + FORM_BYTES,
            "/v1/recognize": settings.max_upload_bytes + FORM_BYTES,
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 413 at once where Content-Length is over the limit, else count what comes."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        path = path_of(scope)
        is_form = media_type(Headers(scope=scope)) == FORM
        limit = self._limits.get(path, JSON_BYTES) if is_form else JSON_BYTES
        if _declares_more_than(limit, scope):
            await _refuse(limit, scope, receive, send)
        else:
            await self.app(scope, _counted(limit, receive), send)


def _declares_more_than(limit: int, scope: Scope) -> bool:
    declared = Headers(scope=scope).get("content-length", "0")
    return not declared.isdecimal() or int(declared[:20]) > limit


async def _refuse(limit: int, scope: Scope, receive: Receive, send: Send) -> None:
    waits = Headers(scope=scope).get("expect", "").lower() == "100-continue"

    async def send_then_drain(message: Message) -> None:
        if message["type"] != "http.response.body" or waits:
            await send(message)
            return
        await send({**message, "more_body": True})
        await _drain(receive)
        await send({"type": "http.response.body", "body": b"", "more_body": False})

    refusal = respond(problem_of(_too_large(limit)), {"Connection": "close"})
    await refusal(scope, receive, send_then_drain)


def _counted(limit: int, receive: Receive) -> Receive:
    total = 0

    async def counted() -> Message:
        nonlocal total
        message = await receive()
        total += len(message.get("body", b""))
        if total > limit:
            await _drain(receive)
            # An HTTPException, because FastAPI passes only those through its body reader.
            raise HTTPException(413, _too_large(limit).detail, {"Connection": "close"})
        return message

    return counted


def _too_large(limit: int) -> TooLarge:
    return TooLarge(f"The body is larger than the limit of {limit} bytes.")


async def _drain(receive: Receive) -> None:
    dropped, more = 0, True
    while more and dropped < MOST_DRAINED:
        message = await receive()
        more = message["type"] == "http.request" and message.get("more_body", False)
        dropped += len(message.get("body", b""))
