"""The keys of the metadata in a library, with their kinds, counts and values."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from sqlalchemy import func, select

from app.store.clips.metadata_values import MetadataValue, ValueKind, from_text, tidy_number
from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, read_cursor, write_cursor
from app.store.database.tables import clip_metadata

SORT = "key"


@dataclass(frozen=True, slots=True)
class ValueCount:
    """A value, and the number of clips that have it."""

    value: MetadataValue
    count: int


@dataclass(slots=True)
class MetadataKey:
    """A key. count: clips that have it; kinds: clips by the kind of their value; minimum, maximum:
    of the numbers, None without any; values: the most frequent ones."""

    name: str
    count: int = 0
    kinds: dict[ValueKind, int] = field(default_factory=dict)
    minimum: float | None = None
    maximum: float | None = None
    values: tuple[ValueCount, ...] = ()


def page(tx: Tx, max_values: int, limit: int, cursor: str | None = None) -> Page[MetadataKey]:
    """At most `limit` keys, sorted by name, each with its most frequent values.

    Raises PageNotFound at "cursor".
    """
    after = None if cursor is None else read_cursor(cursor, SORT, str).value
    keys = _counted(tx, limit + 1, after)
    shown = keys[:limit]
    for key in shown:
        key.values = _values(tx, key.name, max_values)
    if len(keys) <= limit:
        return Page(tuple(shown), None)
    return Page(tuple(shown), write_cursor(SORT, Position(shown[-1].name, "")))


def _counted(tx: Tx, limit: int, after: object) -> list[MetadataKey]:
    """The first keys after a name, without their values.

    One walk through an index that has all these columns: GROUP BY kind would sort all rows.
    """
    column, count = clip_metadata.c, func.count()
    kinds = [count.filter(column.kind == kind.value) for kind in ValueKind]
    query = (
        select(column.key, func.min(column.number), func.max(column.number), *kinds)
        .group_by(column.key)
        .order_by(column.key)
        .limit(limit)
    )
    rows = tx.execute(query if after is None else query.where(column.key > after))
    return [_key(name, lowest, highest, counts) for name, lowest, highest, *counts in rows]


def _key(
    name: str, lowest: float | None, highest: float | None, counts: Sequence[int]
) -> MetadataKey:
    kinds = {kind: count for kind, count in zip(ValueKind, counts, strict=True) if count}
    minimum = None if lowest is None else tidy_number(lowest)
    maximum = None if highest is None else tidy_number(highest)
    return MetadataKey(name, sum(counts), kinds, minimum, maximum)


def _values(tx: Tx, name: str, limit: int) -> tuple[ValueCount, ...]:
    column = clip_metadata.c
    count = func.count()
    query = (
        select(column.kind, column.text, count)
        .where(column.key == name)
        .group_by(column.text, column.kind)
        .order_by(count.desc(), column.text, column.kind)
        .limit(limit)
    )
    rows = tx.execute(query)
    return tuple(ValueCount(from_text(kind, text), number) for kind, text, number in rows)
