"""Unknown fields of a request, with the known name that is nearest to each."""

from __future__ import annotations

import difflib
from collections.abc import Collection
from typing import get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError
from pydantic_core.core_schema import ErrorType

UNKNOWN_FIELD = "unknown_field"
"""The type of the error of an unknown field that resembles a known one."""
_STANDARD = frozenset(get_args(ErrorType))


def with_near_names(error: ValidationError, known: Collection[str]) -> ValidationError:
    """The same errors; an unknown field says which of the known names may be meant.

    known: the names of the fields of the model that found the errors.
    """
    details = error.errors(include_url=False)
    if not any(_near(detail, known) for detail in details):
        return error
    lines = [_as_line(detail, _near(detail, known)) for detail in details]
    return ValidationError.from_exception_data(error.title, lines)


def _near(detail: ErrorDetails, known: Collection[str]) -> str | None:
    """The known name that is nearest to an unknown field of this model, if one is near."""
    if detail["type"] != "extra_forbidden" or len(detail["loc"]) != 1:
        return None
    matches = difflib.get_close_matches(str(detail["loc"][0]), known, n=1)
    return matches[0] if matches else None


def _as_line(detail: ErrorDetails, near: str | None) -> InitErrorDetails:
    line = InitErrorDetails(type=_type_of(detail, near), loc=detail["loc"], input=detail["input"])
    if isinstance(line["type"], str) and "ctx" in detail:
        line["ctx"] = detail["ctx"]
    return line


def _type_of(detail: ErrorDetails, near: str | None) -> str | PydanticCustomError:
    if near is not None:
        message = f"This call has no such field; did you mean {near}?"
        return PydanticCustomError(UNKNOWN_FIELD, message)
    if detail["type"] in _STANDARD:
        return detail["type"]
    return PydanticCustomError(detail["type"], detail["msg"])
