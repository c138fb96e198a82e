"""A problem (RFC 9457) as an HTTP answer."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from fastapi.responses import JSONResponse

from app.api.failures.problems import MEDIA_TYPE


def respond(problem: Mapping[str, Any], headers: Mapping[str, str] | None = None) -> JSONResponse:
    """Return the answer whose body is the members of a problem."""
    return JSONResponse(
        problem, status_code=problem["status"], media_type=MEDIA_TYPE, headers=dict(headers or {})
    )
