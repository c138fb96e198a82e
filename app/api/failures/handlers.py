"""Handlers that answer every failure with a problem (RFC 9457)."""

from __future__ import annotations

import errno
import logging
from http import HTTPMethod
from typing import cast

from fastapi import FastAPI, Request, Response
from fastapi.exceptions import RequestValidationError
from starlette.exceptions import HTTPException
from starlette.routing import BaseRoute, Match
from starlette.types import Scope

from app.api.failures.problems import (
    RETRY_AFTER_SECONDS,
    NotReadyYet,
    RateLimited,
    TooBusy,
    problem,
    problem_of,
    problem_of_http,
    problem_of_validation,
    status_of,
)
from app.api.failures.response import respond
from app.errors import (
    AnalysisInterrupted,
    BadField,
    CallInProgress,
    Conflict,
    DeadlineExceeded,
    DiskFull,
    ModelBeingFitted,
    NotFound,
    Unauthorized,
)
from app.kinedex_error import KinedexError, Place

log = logging.getLogger(__name__)

FIT_SECONDS = "5"
"""Retry-After while a model is being fitted. A fit takes from a second to a minute."""


_TEMPORARY = (NotReadyYet, TooBusy, DeadlineExceeded, AnalysisInterrupted)
"""Failures that are no defect: the same call may succeed a moment later."""


def install_handlers(app: FastAPI) -> None:
    """Answer failures of Kinedex, of the router and of validation with problems."""
    app.add_exception_handler(KinedexError, answer_failure)
    app.add_exception_handler(RequestValidationError, _on_validation)
    app.add_exception_handler(HTTPException, _on_http)


def answer_unexpected(error: Exception) -> Response:
    """Answer 507 if the disk is full, else 500. Only the log gets the exception's text."""
    if isinstance(error, OSError) and error.errno in {errno.ENOSPC, errno.EDQUOT}:
        log.error("disk full")
        return respond(problem_of(DiskFull()))
    log.error("unexpected exception", exc_info=error)
    return respond(problem(500, "internal", "Something went wrong; the log has the details."))


async def answer_failure(request: Request, error: Exception) -> Response:
    """Answer a KinedexError with a problem. An internal failure is also logged."""
    failure = cast(KinedexError, error)
    if isinstance(failure, (BadField, NotFound, Conflict)):
        failure = _located(failure, request)
    if status_of(type(failure)) >= 500 and not isinstance(failure, _TEMPORARY):
        log.error("failure: %s", failure.detail, exc_info=failure)
    return respond(problem_of(failure), _headers(failure))


def _headers(failure: KinedexError) -> dict[str, str]:
    if isinstance(failure, RateLimited):
        return failure.headers
    if isinstance(failure, Unauthorized):
        return {"WWW-Authenticate": "Bearer"}
    if isinstance(failure, _TEMPORARY):
        return {"Retry-After": RETRY_AFTER_SECONDS}
    if isinstance(failure, CallInProgress):
        return {"Retry-After": RETRY_AFTER_SECONDS}
    if isinstance(failure, ModelBeingFitted):
        return {"Retry-After": FIT_SECONDS}
    return {}


def _located(failure: KinedexError, request: Request) -> KinedexError:
    """Put the part of the request (query, body or path) before the fields that services name."""
    return type(failure)(
        failure.detail,
        places=[
            place
            if place.location.startswith(("query.", "body.", "path.", "header."))
            else Place(f"{_part(place.location, request)}.{place.location}", place.message)
            for place in failure.places
        ],
    )


def _part(field: str, request: Request) -> str:
    if field in request.path_params:
        return "path"
    return "query" if request.method == "GET" else "body"


async def _on_validation(_request: Request, error: Exception) -> Response:
    return respond(problem_of_validation(cast(RequestValidationError, error).errors()))


async def _on_http(request: Request, error: Exception) -> Response:
    refusal = cast(HTTPException, error)
    if refusal.status_code == 405:
        allowed = ", ".join(_methods_of(request))
        detail = f"This path takes {allowed}, not {request.method}."
        return respond(problem_of_http(405, detail), {"Allow": allowed})
    return respond(problem_of_http(refusal.status_code, refusal.detail), refusal.headers)


def _methods_of(request: Request) -> list[str]:
    """The methods of all routes of the path. The router names those of the first one only."""
    routes: list[BaseRoute] = request.app.routes
    return [
        method.value
        for method in sorted(HTTPMethod)
        if any(_takes(route, {**request.scope, "method": method.value}) for route in routes)
    ]


def _takes(route: BaseRoute, scope: Scope) -> bool:
    return route.matches(scope)[0] is Match.FULL
