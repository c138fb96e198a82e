"""A limit on the size of a request's body.

It checks the Content-Length first, and counts the bytes that arrive.
"""

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

MAX_FORM_TEXT_BYTES = 2**20
"""Bytes of a form besides its file."""
MAX_JSON_BYTES = 2**20
"""Bytes of a JSON body: while JSON is parsed, the process answers nothing else."""
MAX_DRAINED_BYTES = 16 * 2**20
"""Bytes read and dropped after a refusal: many clients read the answer only after they have sent
their whole body."""


class BodyLimit:
    """ASGI middleware: it refuses a body over the limit of its path with 413."""

    def __init__(self, app: ASGIApp, settings: Settings) -> None:
        self.app = app
        self._limits = {
            "/v1/imports": settings.max_archive_bytes + MAX_FORM_TEXT_BYTES,
            "/v1/clips": settings.max_upload_bytes + MAX_FORM_TEXT_BYTES,
            "/v1/search": settings.max_upload_bytes + MAX_FORM_TEXT_BYTES,
            "/v1/search/motion": settings.max_upload_bytes + MAX_FORM_TEXT_BYTES,
            "/v1/search/pose": settings.max_upload_bytes + MAX_FORM_TEXT_BYTES,
            "/v1/recognize": settings.max_upload_bytes + MAX_FORM_TEXT_BYTES,
        }

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer 413 at once if Content-Length is over the limit, else count the bytes."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        path = path_of(scope)
        is_form = media_type(Headers(scope=scope)) == FORM
        limit = self._limits.get(path, MAX_JSON_BYTES) if is_form else MAX_JSON_BYTES
        if _declares_more_than(limit, scope):
            await _refuse(limit, scope, receive, send)
        else:
            await self.app(scope, _counted(limit, receive), send)


def _declares_more_than(limit: int, scope: Scope) -> bool:
    declared = Headers(scope=scope).get("content-length", "0")
    # 20 digits are enough for any limit. int() raises ValueError for thousands of digits.
    return not declared.isdecimal() or int(declared[:20]) > limit


async def _refuse(limit: int, scope: Scope, receive: Receive, send: Send) -> None:
    # This client sends its body only after we ask for it, so there is nothing to drain.
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
    while more and dropped < MAX_DRAINED_BYTES:
        message = await receive()
        more = message["type"] == "http.request" and message.get("more_body", False)
        dropped += len(message.get("body", b""))
