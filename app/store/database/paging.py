"""Pages of a list, with opaque cursors. A cursor names the row after which the next page begins.

A cursor holds the sort, and the id and sorted value of the last row. So if rows are added or
removed between two pages, no other row appears twice or is missed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Generic, TypeVar

from sqlalchemy import ColumnElement, and_, or_

from app.errors import PageNotFound
from app.kinedex_error import Place
from app.store.database import cursor_codec
from app.store.database.cursor_codec import as_number, as_text
from app.store.database.totals import Total

Item = TypeVar("Item")
Value = str | float | datetime


@dataclass(frozen=True, slots=True)
class Page(Generic[Item]):
    """One page. next: the cursor of the following page, None on the last page.

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
    """The position of a row in a sorted list: its value in the sorted column, then its id."""

    value: Value
    id: str


def write_cursor(sort: str, position: Position) -> str:
    """A URL-safe cursor for the page after `position`."""
    value = position.value
    plain = value.isoformat() if isinstance(value, datetime) else value
    return cursor_codec.encode([sort, plain, position.id])


def read_cursor(cursor: str, sort: str, kind: type[Value]) -> Position:
    """The position in a cursor.

    kind: the type of the sorted column. Raises PageNotFound at "cursor" if the text is no cursor,
    or if it was written for another sort.
    """
    try:
        cursor_sort, value, row_id = cursor_codec.decode(cursor)
        if cursor_sort == sort:
            return Position(_as_kind(value, kind), as_text(row_id))
    except ValueError:  # NotACursor, or another number of values
        pass
    raise PageNotFound(
        places=[Place("cursor", "expected the `next` of a page with the same sort and filter")],
    )


def after(
    column: ColumnElement[Value],
    row_id: ColumnElement[str],
    position: Position,
    *,
    descending: bool,
) -> ColumnElement[bool]:
    """The condition for rows after `position`, sorted by the column; the id breaks ties."""
    if descending:
        is_after, is_after_in_tie = column < position.value, row_id < position.id
    else:
        is_after, is_after_in_tie = column > position.value, row_id > position.id
    return or_(is_after, and_(column == position.value, is_after_in_tie))


def _as_kind(value: object, kind: type[Value]) -> Value:
    if kind is str:
        return as_text(value)
    if kind is datetime:
        return _as_time(value)
    return as_number(value)


def _as_time(value: object) -> datetime:
    time = datetime.fromisoformat(as_text(value))
    if time.tzinfo is None:
        raise ValueError("a time without a time zone")
    try:
        return time.astimezone(UTC)
    except OverflowError as problem:  # in the year 1 or 9999
        raise ValueError("a time outside the calendar") from problem
