"""The one source whose clips the current call may see, if its API key is for one source.

The source is a condition of every filter (`filter.condition`, and `mask` of the search index), and
clips of other sources do not exist for whoever reads clips by id (`repository`, `partial`). Only
the routes that read clips in these ways take such a key (`app.api.deps`). The indexes in memory are
shared by all calls: `index_feed`, which fills them, reads all clips.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeVar

from sqlalchemy import ColumnElement, Select, func, true

from app.store.database.tables import clips

_Row = TypeVar("_Row", bound=tuple[object, ...])


@contextmanager
def only_source(source: str | None) -> Iterator[None]:
    """In the block, only the clips of this source exist; None: all clips do."""
    token = _source.set(source)
    try:
        yield
    finally:
        _source.reset(token)


def visible_source() -> str | None:
    """The only source whose clips exist; None if all clips do."""
    return _source.get()


def is_visible() -> ColumnElement[bool]:
    """The condition for clips that exist."""
    source = _source.get()
    return true() if source is None else clips.c.source == source


def of_visible(query: Select[_Row]) -> Select[_Row]:
    """A query of clips by their ids, without those that are not visible."""
    source = _source.get()
    # Most calls see all clips: then the query stays the one that was built once.
    if source is None:
        return query
    # No index has this expression. With the index of the source, SQLite would read all its clips.
    return query.where(func.nullif(clips.c.source, "") == source)


_source: ContextVar[str | None] = ContextVar("visible_source", default=None)
