"""Answers: problem. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Record


@dataclass(frozen=True, slots=True)
class ProblemPlace(Record):
    """One error, with its location.

    location: Line, joint, frame or field: `line 12`, `body.limit`.
    """

    location: str
    message: str


@dataclass(frozen=True, slots=True)
class Problem(Record):
    """A failure (RFC 9457, application/problem+json).

    code: Stable name of the failure for programs.
    """

    type: str
    title: str
    status: int
    detail: str
    code: str
    errors: list[ProblemPlace]
