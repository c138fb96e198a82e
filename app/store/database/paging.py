"""Pages of a list: opaque cursors that say after which row the next page begins.

A cursor names the last row's place in the order, so rows that come and go between two pages
never make one of the others appear twice or not at all.
"""

from __future__ import annotations

import base64
import json
import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Generic, TypeVar

from sqlalchemy import ColumnElement, and_, or_

from app.errors import BadField, Place

Item = TypeVar("Item")
Value = str | float | datetime
MAX_CURSOR_LENGTH = 4096


@dataclass(frozen=True, slots=True)
class Page(Generic[Item]):
    """One page; next: the cursor of the page after it, None on the last."""

    items: tuple[Item, ...]
    next: str | None


@dataclass(frozen=True, slots=True)
class Position:
    """A row's place in a list: its value in the sorted column, then its id."""

    value: Value
    id: str


def write_cursor(sort: str, position: Position) -> str:
    """A URL-safe cursor for the page after `position`."""
    value = position.value
    plain = value.isoformat() if isinstance(value, datetime) else value
    # Not escaped: a long name of another script than Latin would outgrow MAX_CURSOR_LENGTH.
    content = json.dumps([sort, plain, position.id], separators=(",", ":"), ensure_ascii=False)
    return base64.urlsafe_b64encode(content.encode()).decode().rstrip("=")


def read_cursor(cursor: str, sort: str, kind: type[Value]) -> Position:
    """The position that a cursor of the same sort holds; raises BadField at "cursor"."""
    try:
        said, value, row_id = json.loads(_unpad(cursor))
        if said == sort:
            return Position(_as_kind(value, kind), _as_text(row_id))
    except (ValueError, TypeError, OverflowError, RecursionError):
        pass
    raise BadField(
        "The cursor is not one that this list gave",
        places=[Place("cursor", "expected the `next` of a page with the same sort and filter")],
    )


def after(
    column: ColumnElement[Value],
    row_id: ColumnElement[str],
    position: Position,
    *,
    descending: bool,
) -> ColumnElement[bool]:
    """Rows that come after `position` when sorted by the column, ties by id."""
    if descending:
        further, tie_further = column < position.value, row_id < position.id
    else:
        further, tie_further = column > position.value, row_id > position.id
    return or_(further, and_(column == position.value, tie_further))


def _unpad(cursor: str) -> bytes:
    if len(cursor) > MAX_CURSOR_LENGTH:
        raise ValueError
    padded = cursor + "=" * (-len(cursor) % 4)
    return base64.b64decode(padded.encode("ascii"), altchars=b"-_", validate=True)


def _as_kind(value: object, kind: type[Value]) -> Value:
    if kind is str:
        return _as_text(value)
    if kind is datetime:
        return _as_moment(value)
    return _as_number(value)


def _as_text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError
    value.encode()  # a lone surrogate is valid JSON, but no database takes it
    return value


def _as_moment(value: object) -> datetime:
    moment = datetime.fromisoformat(_as_text(value))
    if moment.tzinfo is None:
        raise ValueError
    return moment.astimezone(UTC)


def _as_number(value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    number = float(value)
    if not math.isfinite(number):
        raise ValueError
    return number
