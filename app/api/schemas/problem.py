"""Problems (RFC 9457)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BeforeValidator, ConfigDict, Field

from app.api.failures.problems import stored_problem
from app.api.schemas.base import Outgoing


class ProblemPlace(Outgoing):
    """One error, with its location."""

    location: str = Field(description="Line, joint, frame or field: `line 12`, `body.limit`.")
    message: str


class Problem(Outgoing):
    """A failure (RFC 9457, application/problem+json)."""

    type: str
    title: str
    status: int
    detail: str
    code: str = Field(description="Stable name of the failure for programs.")
    errors: list[ProblemPlace]

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "type": "urn:kinedex:problem:unreadable",
                    "title": "The file cannot be read as its format",
                    "status": 422,
                    "detail": "The file cannot be read as its format.",
                    "code": "unreadable",
                    "errors": [{"location": "line 12", "message": "a number was expected"}],
                }
            ]
        }
    )


def _complete(stored: Mapping[str, Any] | None) -> dict[str, Any] | None:
    return None if stored is None else stored_problem(stored)


StoredProblem = Annotated[Problem | None, BeforeValidator(_complete)]
"""The stored failure of a clip, a job or a file of an import, completed to a problem."""
