"""The failures of calls."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

UNREACHABLE_STATUS = 0
"""The status of a failure without an answer."""


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is wrong (a line, joint, frame or field), and what was expected there."""

    location: str
    message: str


class KinedexError(Exception):
    """A call failed. The members are those of the problem in the answer (RFC 9457).

    status: the HTTP status. code: a stable name of the failure for programs. title: the kind of
    failure. detail: what went wrong. errors: each wrong part with its location. retry_after:
    seconds after which the call may succeed, or None.
    """

    def __init__(
        self,
        detail: str,
        *,
        status: int = UNREACHABLE_STATUS,
        code: str = "internal",
        title: str = "",
        errors: Sequence[Place] = (),
        retry_after: float | None = None,
    ) -> None:
        super().__init__(detail)
        self.detail = detail
        self.status = status
        self.code = code
        self.title = title
        self.errors = tuple(errors)
        self.retry_after = retry_after


class Unreachable(KinedexError):
    """The service cannot be reached, or the connection broke."""


class JobFailed(KinedexError):
    """A job that the program waited for failed or was canceled. job_id: its id."""

    def __init__(self, detail: str, *, job_id: str, **members: Any) -> None:
        super().__init__(detail, **members)
        self.job_id = job_id


class PackageNeeded(KinedexError, ImportError):
    """This needs a package that is not installed."""

    def __init__(self, package: str, purpose: str) -> None:
        detail = f"{purpose} needs {package}: pip install {package}"
        super().__init__(detail, code="package_needed", title="A package is not installed")


def failure_of(status: int, content: bytes, retry_after: str | None = None) -> KinedexError:
    """The failure that an answer describes, also if a proxy wrote the answer and not Kinedex."""
    try:
        problem = json.loads(content)
    except ValueError:
        problem = None
    if not isinstance(problem, dict) or "detail" not in problem:
        text = content[:200].decode("utf-8", "replace").strip()
        problem = {"detail": f"The service answered {status}{': ' if text else ''}{text}"}
    return KinedexError(
        str(problem["detail"]),
        status=status,
        code=str(problem.get("code", "internal")),
        title=str(problem.get("title", "")),
        errors=places_of(problem),
        retry_after=seconds_of(retry_after),
    )


def places_of(problem: Mapping[str, Any]) -> list[Place]:
    """The places that a problem names."""
    return [Place(str(p["location"]), str(p["message"])) for p in problem.get("errors", [])]


def seconds_of(header: str | None) -> float | None:
    """The seconds of a Retry-After header. None without one, or if it holds a date."""
    try:
        return None if header is None else max(float(header), 0.0)
    except ValueError:
        return None
