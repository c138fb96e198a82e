"""Saved searches: a query by its name, and which hits were seen when it was last looked at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import RowMapping, delete, insert, select, update

from app.errors import Conflict, SearchNotFound
from app.kinedex_error import Place
from app.store.clips import versions as library
from app.store.database.collection_tables import saved_searches
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.totals import Total, total_of

NEWEST_FIRST = "-created_at"


@dataclass(frozen=True, slots=True)
class SearchRecord:
    """A saved search.

    query: as a client sent it; seen: ids of the clips that were hits when it was last looked at;
    seen_version: the version of the library then.
    """

    id: str
    name: str
    query: dict[str, Any]
    seen: tuple[str, ...]
    seen_version: int
    seen_at: datetime | None
    created_at: datetime


def add(tx: Tx, name: str, query: Mapping[str, Any]) -> SearchRecord:
    """Saves a search that nobody has looked at. Raises Conflict if there is one of this name."""
    library.lock(tx)  # so that no other process adds the name after the look-up
    _check_free(tx, name, None)
    search_id = new_id("search")
    row = {
        "id": search_id,
        "name": name,
        "query": dict(query),
        "seen": [],
        "seen_version": 0,
        "created_at": utc_now(),
    }
    tx.execute(insert(saved_searches), row)
    return get(tx, search_id)


def get(tx: Tx, search_id: str) -> SearchRecord:
    """The saved search. Raises SearchNotFound."""
    query = select(saved_searches).where(saved_searches.c.id == search_id)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        detail = f"There is no saved search with the id {search_id!r}"
        raise SearchNotFound(detail, places=[Place("search_id", "is the id of no saved search")])
    return _to_record(row)


def list_page(tx: Tx, *, limit: int, cursor: str | None = None) -> Page[SearchRecord]:
    """One page of saved searches, newest first; raises PageNotFound at "cursor"."""
    created, row_id = saved_searches.c.created_at, saved_searches.c.id
    query = select(saved_searches)
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        query = query.where(after(created, row_id, position, descending=True))
    query = query.order_by(created.desc(), row_id.desc()).limit(limit + 1)
    found = [_to_record(row) for row in tx.execute(query).mappings()]
    shown = tuple(found[:limit])
    if len(found) <= limit:
        return Page(shown, None)
    return Page(shown, write_cursor(NEWEST_FIRST, Position(shown[-1].created_at, shown[-1].id)))


def total(tx: Tx) -> Total:
    """How many saved searches there are."""
    return total_of(tx, select(saved_searches.c.id))


def every(tx: Tx) -> list[SearchRecord]:
    """All saved searches."""
    return [_to_record(row) for row in tx.execute(select(saved_searches)).mappings()]


def change(
    tx: Tx, search_id: str, *, name: str | None = None, query: Mapping[str, Any] | None = None
) -> SearchRecord:
    """Changes name and query; None leaves one as it is. Raises SearchNotFound, Conflict."""
    library.lock(tx)
    get(tx, search_id)
    if name is not None:
        _check_free(tx, name, search_id)
    given = {"name": name, "query": None if query is None else dict(query)}
    values = {key: value for key, value in given.items() if value is not None}
    if values:
        tx.execute(_of(search_id).values(**values))
    return get(tx, search_id)


def mark_seen(tx: Tx, search_id: str, clip_ids: Sequence[str], version: int) -> SearchRecord:
    """Notes the hits that were seen at a version of the library. Raises SearchNotFound."""
    get(tx, search_id)
    seen = {"seen": list(clip_ids), "seen_version": version, "seen_at": utc_now()}
    tx.execute(_of(search_id).values(**seen))
    return get(tx, search_id)


def remove(tx: Tx, search_id: str) -> None:
    """Removes a saved search. Raises SearchNotFound."""
    get(tx, search_id)
    tx.execute(delete(saved_searches).where(saved_searches.c.id == search_id))


def rewrite(tx: Tx, search_id: str, name: str, query: Mapping[str, Any]) -> None:
    """Stores another name and query. A name that is taken gets the id behind it."""
    taken = select(saved_searches.c.id).where(
        saved_searches.c.name == name, saved_searches.c.id != search_id
    )
    if tx.execute(taken).first() is not None:
        name = f"{name} {search_id}"
    tx.execute(_of(search_id).values(name=name, query=dict(query)))


def _of(search_id: str) -> Any:
    return update(saved_searches).where(saved_searches.c.id == search_id)


def _to_record(row: RowMapping) -> SearchRecord:
    return SearchRecord(**{**row, "query": dict(row["query"]), "seen": tuple(row["seen"])})


def _check_free(tx: Tx, name: str, own_id: str | None) -> None:
    named = select(saved_searches.c.id).where(saved_searches.c.name == name)
    holder = tx.execute(named).scalar()
    if holder is not None and holder != own_id:
        raise Conflict(
            f"There is a saved search with the name {name!r} already.",
            places=[Place("name", f"is the name of {holder}")],
        )
