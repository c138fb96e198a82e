"""The keys of the metadata in a library, with their kinds, counts and values."""

from __future__ import annotations

from collections.abc import Collection
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

    Raises BadField at "cursor".
    """
    after = None if cursor is None else read_cursor(cursor, SORT, str).value
    names = _names(tx, limit + 1, after)
    shown = names[:limit]
    keys = _counted(tx, shown)
    for name in shown:
        keys[name].values = _values(tx, name, max_values)
    items = tuple(keys[name] for name in shown)
    if len(names) <= limit:
        return Page(items, None)
    return Page(items, write_cursor(SORT, Position(shown[-1], "")))


def _names(tx: Tx, limit: int, after: object) -> list[str]:
    column = clip_metadata.c.key
    query = select(column).distinct().order_by(column).limit(limit)
    return list(tx.execute(query if after is None else query.where(column > after)).scalars())


def _counted(tx: Tx, names: Collection[str]) -> dict[str, MetadataKey]:
    column = clip_metadata.c
    query = (
        select(
            column.key,
            column.kind,
            func.count(),
            func.min(column.number),
            func.max(column.number),
        )
        .where(column.key.in_(names))
        .group_by(column.key, column.kind)
    )
    keys = {name: MetadataKey(name) for name in names}
    for name, kind, count, minimum, maximum in tx.execute(query):
        key = keys[name]
        key.count += count
        key.kinds[ValueKind(kind)] = count
        if kind == ValueKind.NUMBER:
            key.minimum, key.maximum = tidy_number(minimum), tidy_number(maximum)
    return keys


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
