"""Failures as problem+json (RFC 9457). Only this module knows the HTTP statuses of failures.

Members: `type title status detail code errors`; each of `errors` has `location`
(as `body.limit`, `query.cursor`, `line 12`) and `message`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from http import HTTPStatus
from typing import Any

from pydantic_core import ErrorDetails

from app import errors
from app.kinedex_error import KinedexError, Place

MEDIA_TYPE = "application/problem+json"
TYPE_PREFIX = "urn:kinedex:problem:"
RETRY_AFTER_SECONDS = "1"
MAX_ERRORS = 100
"""Entries of `errors` in one problem: a client with a thousand wrong fields needs no more."""


class NotReadyYet(KinedexError):
    """The service is starting: its index is not loaded yet."""

    code = "not_ready"


class Unhealthy(NotReadyYet):
    """The service cannot work because its store is damaged or missing."""

    code = "unhealthy"


class TooBusy(KinedexError):
    """The service is too busy; try again shortly."""

    code = "too_busy"


class RateLimited(KinedexError):
    """Too many calls; try again later.

    retry_after: seconds; headers: further headers of the answer.
    """

    code = "rate_limited"

    def __init__(
        self,
        detail: str | None = None,
        *,
        retry_after: int = 1,
        headers: Mapping[str, str] | None = None,
    ) -> None:
        super().__init__(detail)
        self.headers = {**(headers or {}), "Retry-After": str(retry_after)}


class TooManyConnections(KinedexError):
    """Too many connections are open; try again shortly."""

    code = "too_many_connections"


class RequestTimeout(KinedexError):
    """The request came too slowly."""

    code = "request_timeout"


class UnknownMethod(KinedexError):
    """This HTTP method does not exist."""

    code = "unknown_method"


class ReaderTooSlow(KinedexError):
    """The client reads the answer too slowly."""

    code = "reader_too_slow"


class MalformedBody(KinedexError):
    """The body does not match its Content-Type."""

    code = "malformed_body"


class UnsupportedMediaType(KinedexError):
    """The body is of a media type that this call does not take."""

    code = "unsupported_media_type"


CLIENT_LEFT = 499
"""The log's status (as in nginx's logs) if the client left before the answer. It is never sent."""

STATUSES: dict[type[KinedexError], int] = {
    MalformedBody: 400,
    errors.Unauthorized: 401,
    errors.Forbidden: 403,
    errors.NotFound: 404,
    RequestTimeout: 408,
    ReaderTooSlow: 408,
    errors.Conflict: 409,
    errors.Canceled: 409,
    errors.TooLarge: 413,
    errors.UnknownFormat: 415,
    errors.FormatNotSupported: 415,
    UnsupportedMediaType: 415,
    errors.BadContent: 422,
    errors.BadField: 422,
    errors.StorageError: 500,
    errors.ConfigurationError: 500,
    KinedexError: 500,
    RateLimited: 429,
    UnknownMethod: 501,
    errors.ClientLeft: CLIENT_LEFT,
    NotReadyYet: 503,
    TooBusy: 503,
    TooManyConnections: 503,
    errors.AnalysisInterrupted: 503,
    errors.DeadlineExceeded: 503,
    errors.DiskFull: 507,
}
"""HTTP status by class of failure. A class that is not listed has the status of its nearest
ancestor."""

_ROUTER_CODES = {
    404: "not_found",
    405: "method_not_allowed",
    413: "too_large",
    503: TooBusy.code,
}
_DETAIL_IS_SAFE = {501, 503, 507}
"""Statuses of 500 and above whose detail holds nothing internal, so that clients may see it."""


def status_of(kind: type[KinedexError]) -> int:
    """Return the HTTP status of a class of failures."""
    return next(STATUSES[base] for base in kind.__mro__ if base in STATUSES)


def problem(
    status: int,
    code: str,
    detail: str,
    *,
    title: str | None = None,
    places: Iterable[Mapping[str, str]] = (),
) -> dict[str, Any]:
    """Return the members of a problem, in the order in which clients see them."""
    return {
        "type": TYPE_PREFIX + code,
        "title": title or HTTPStatus(status).phrase,
        "status": status,
        "detail": detail,
        "code": code,
        "errors": list(places)[:MAX_ERRORS],
    }


def problem_of(error: KinedexError) -> dict[str, Any]:
    """Return a failure as a problem. Details of an internal failure are hidden."""
    status = status_of(type(error))
    places = [{"location": p.location, "message": p.message} for p in error.places]
    hidden = status >= 500 and status not in _DETAIL_IS_SAFE
    return problem(
        status,
        error.code,
        error.title() if hidden else error.detail,
        title=error.title(),
        places=() if hidden else places,
    )


def problem_of_http(status: int, detail: str) -> dict[str, Any]:
    """Return an HTTPException of Starlette (no such path, method not allowed) as a problem."""
    code = _ROUTER_CODES.get(status) or HTTPStatus(status).name.lower()
    return problem(status, code, detail)


def problem_of_validation(found: Iterable[ErrorDetails | Mapping[str, Any]]) -> dict[str, Any]:
    """Return the errors of request validation as a problem: 422, or 400 for unreadable JSON."""
    details = list(found)
    if any(_whole_body_is_not_json(detail) for detail in details):
        return problem_of(MalformedBody("The body is not valid JSON."))
    places = [Place(location_of(detail["loc"]), _message_of(detail)) for detail in details]
    return problem_of(errors.BadField("The request has fields that are wrong.", places=places))


def _message_of(detail: ErrorDetails | Mapping[str, Any]) -> str:
    if detail["type"] == "extra_forbidden":
        return "This call has no such field."
    # pydantic puts this prefix before the messages of our own validators
    return str(detail["msg"]).removeprefix("Value error, ")


def _whole_body_is_not_json(detail: ErrorDetails | Mapping[str, Any]) -> bool:
    # Of a whole body FastAPI gives the offset, ("body", 17); of a form's JSON field the name.
    location = detail["loc"][1:]
    return detail["type"] == "json_invalid" and all(isinstance(step, int) for step in location)


def location_of(path: Iterable[int | str]) -> str:
    """Join a path of names and indices, as in `body.words.3`."""
    return ".".join(str(step) for step in path)


def stored_problem(stored: Mapping[str, Any]) -> dict[str, Any]:
    """Complete a failure that a clip or job stores (`KinedexError.as_problem`) to a problem."""
    code = str(stored.get("code", KinedexError.code))
    status = _status_by_code().get(code, 500)
    return problem(
        status,
        code,
        str(stored.get("detail", "")),
        title=stored.get("title"),
        places=stored.get("errors", ()),
    )


def _status_by_code() -> dict[str, int]:
    return {kind.code: status_of(kind) for kind in _kinds(KinedexError)}


def _kinds(kind: type[KinedexError]) -> list[type[KinedexError]]:
    return [kind] + [deeper for child in kind.__subclasses__() for deeper in _kinds(child)]
