"""Pages of a list: opaque cursors that say after which row the next page begins.

A cursor holds the sort, and the last row's value in the sorted column and its id. So rows that come
and go between two pages never make another row appear twice or not at all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Generic, TypeVar

from sqlalchemy import ColumnElement, and_, or_

from app.errors import BadField, Place
from app.store.database import cursor_codec
from app.store.database.cursor_codec import as_number, as_text
from app.store.database.totals import Total

Item = TypeVar("Item")
Value = str | float | datetime


@dataclass(frozen=True, slots=True)
class Page(Generic[Item]):
    """One page; next: the cursor of the page after it, None on the last.

    total: the number of rows of all pages, None if nobody counted them; total_is_exact: false if
    it is an estimate.
    """

    items: tuple[Item, ...]
    next: str | None
    total: int | None = None
    total_is_exact: bool = True

    def counted(self, total: Total) -> Page[Item]:
        """The same page with the number of rows of all pages."""
        return replace(self, total=total.count, total_is_exact=total.is_exact)


@dataclass(frozen=True, slots=True)
class Position:
    """Where a row stands in a list: its value in the sorted column, then its id."""

    value: Value
    id: str


def write_cursor(sort: str, position: Position) -> str:
    """A URL-safe cursor for the page after `position`."""
    value = position.value
    plain = value.isoformat() if isinstance(value, datetime) else value
    return cursor_codec.encode([sort, plain, position.id])


def read_cursor(cursor: str, sort: str, kind: type[Value]) -> Position:
    """The position that a cursor of the same sort holds; raises BadField at "cursor"."""
    try:
        found, value, row_id = cursor_codec.decode(cursor)
        if found == sort:
            return Position(_as_kind(value, kind), as_text(row_id))
    except ValueError:
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


def _as_kind(value: object, kind: type[Value]) -> Value:
    if kind is str:
        return as_text(value)
    if kind is datetime:
        return _as_moment(value)
    return as_number(value)


def _as_moment(value: object) -> datetime:
    moment = datetime.fromisoformat(as_text(value))
    if moment.tzinfo is None:
        raise ValueError("a moment without a time zone")
    try:
        return moment.astimezone(UTC)
    except OverflowError as problem:
        raise ValueError("a moment outside the calendar") from problem
