"""Compresses answers by zstd or gzip, if the client accepts one of them.

Octets and media that are compressed already are sent as they are: a motion as float32 becomes
only 8 % smaller, but its compression takes longer than its computation.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from anyio import to_thread
from starlette.datastructures import Headers
from starlette.middleware.gzip import (
    DEFAULT_EXCLUDED_CONTENT_TYPES,
    GZipResponder,
    IdentityResponder,
)
from starlette.types import ASGIApp, Receive, Scope, Send

if TYPE_CHECKING or sys.version_info < (3, 14):
    from backports import zstd
else:
    from compression import zstd

GZIP_LEVEL, ZSTD_LEVEL = 5, 3
MIN_BYTES = 1000
"""A smaller answer fits into one packet in any case."""
MIN_THREAD_BYTES = 32 * 1024
"""A larger piece is compressed in a thread: it would block the event loop for about 1 ms."""
EXCLUDED = (*DEFAULT_EXCLUDED_CONTENT_TYPES, "application/octet-stream")


class Compression:
    """ASGI middleware: it compresses the body of an answer and sets Content-Encoding and Vary."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Call the application with the best encoding that the client accepts."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        await self._responder(Headers(scope=scope))(scope, receive, send)

    def _responder(self, headers: Headers) -> ASGIApp:
        accepted = accepted_encodings(headers.get("accept-encoding", ""))
        if "zstd" in accepted:
            return ZstdResponder(self.app, MIN_BYTES, exclude_content_types=EXCLUDED)
        if "gzip" in accepted:
            return GZipResponder(
                self.app,
                MIN_BYTES,
                GZIP_LEVEL,
                thread_minimum_size=MIN_THREAD_BYTES,
                exclude_content_types=EXCLUDED,
            )
        return IdentityResponder(self.app, MIN_BYTES, exclude_content_types=EXCLUDED)


class ZstdResponder(IdentityResponder):
    """Starlette's responder, with zstd."""

    content_encoding = "zstd"

    def __init__(
        self, app: ASGIApp, minimum_size: int, *, exclude_content_types: tuple[str, ...]
    ) -> None:
        super().__init__(app, minimum_size, exclude_content_types=exclude_content_types)
        self._compressor: zstd.ZstdCompressor | None = None

    async def apply_compression(self, body: bytes, *, more_body: bool) -> bytes:
        """Compress one piece of the body, so that the client can decompress all of it."""
        if len(body) >= MIN_THREAD_BYTES:
            return await to_thread.run_sync(self._compress, body, more_body)
        return self._compress(body, more_body)

    def _compress(self, body: bytes, more_body: bool) -> bytes:
        if self._compressor is None:
            self._compressor = zstd.ZstdCompressor(ZSTD_LEVEL)
        if more_body:
            return self._compressor.compress(body, self._compressor.FLUSH_BLOCK)
        return self._compressor.compress(body, self._compressor.FLUSH_FRAME)


def accepted_encodings(header: str) -> frozenset[str]:
    """Return the names of the encodings in an Accept-Encoding header, without those of q=0."""
    accepted = set()
    for part in header.lower().split(","):
        name, _, parameters = part.partition(";")
        weight = parameters.replace(" ", "").removeprefix("q=")
        if not parameters or weight.strip("0."):
            accepted.add(name.strip())
    return frozenset(accepted)
