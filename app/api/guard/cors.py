"""Pages of other origins may call the API, if the settings name these origins.

A browser asks first (a preflight) whether such a page may send its call. Keys are sent in headers,
never in cookies, so no credentials are allowed.
"""

from __future__ import annotations

from collections.abc import Sequence

from starlette.datastructures import Headers
from starlette.middleware.cors import CORSMiddleware
from starlette.responses import Response
from starlette.types import ASGIApp

from app.api.failures.problems import problem_of
from app.api.failures.response import respond
from app.errors import Forbidden

METHODS = ("DELETE", "GET", "PATCH", "POST", "PUT")
SENT_HEADERS = (
    "Accept",
    "Authorization",
    "Content-Type",
    "Idempotency-Key",
    "If-None-Match",
    "X-API-Key",
    "X-Request-Id",
)
READ_HEADERS = (
    "Allow",
    "Content-Disposition",
    "ETag",
    "Idempotency-Replayed",
    "RateLimit",
    "RateLimit-Policy",
    "Retry-After",
    "X-Frame-Rate",
    "X-Request-Id",
    "X-Shape",
)
"""Headers of an answer that a page of another origin can read."""
PREFLIGHT_SECONDS = 600
"""How long a browser remembers the answer to a preflight."""


class Cors(CORSMiddleware):
    """ASGI middleware: Starlette's, with a problem as the answer to a refused preflight."""

    def __init__(self, app: ASGIApp, origins: Sequence[str]) -> None:
        super().__init__(
            app,
            allow_origins=origins,
            allow_methods=METHODS,
            allow_headers=SENT_HEADERS,
            expose_headers=READ_HEADERS,
            max_age=PREFLIGHT_SECONDS,
        )

    def preflight_response(self, request_headers: Headers) -> Response:
        """Answer a preflight: 200, or 403 if origin, method or headers are not allowed."""
        answer = super().preflight_response(request_headers)
        if answer.status_code == 200:
            return answer
        text = bytes(answer.body).decode()
        detail = f"{text}; KINEDEX_CORS_ORIGINS lists the allowed origins."
        return respond(problem_of(Forbidden(detail)), {"Vary": "Origin"})
