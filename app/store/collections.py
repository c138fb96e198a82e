"""Collections: named sets of clips, or of parts of clips, with an order and notes."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import RowMapping, delete, func, insert, select, update

from app.errors import CollectionNotFound, Conflict, NotFound
from app.kinedex_error import Place
from app.store.clips import versions as library
from app.store.database.collection_tables import collection_items, collections
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.totals import Total, total_of

NEWEST_FIRST = "-created_at"
IN_ORDER = "position"


@dataclass(frozen=True, slots=True)
class CollectionRecord:
    """A collection. size: the number of its items; changed_at: also of its items."""

    id: str
    name: str
    notes: str
    size: int
    created_at: datetime
    changed_at: datetime


@dataclass(frozen=True, slots=True)
class NewItem:
    """A clip to add, or its part from `start` to `end` (seconds; None for its start and end)."""

    clip_id: str
    start: float | None = None
    end: float | None = None
    notes: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class ItemRecord(NewItem):
    """An item of a collection. position: rising within the collection, with gaps."""

    id: str
    position: int


def add(tx: Tx, name: str, notes: str) -> CollectionRecord:
    """Adds an empty collection. Raises Conflict if there is one of this name."""
    library.lock(tx)  # so that no other process adds the name after the look-up
    _check_free(tx, name, None)
    collection_id, now = new_id("collection"), utc_now()
    row = {"id": collection_id, "name": name, "notes": notes, "created_at": now, "changed_at": now}
    tx.execute(insert(collections), row)
    return get(tx, collection_id)


def get(tx: Tx, collection_id: str) -> CollectionRecord:
    """The collection. Raises CollectionNotFound."""
    query = _LISTED.where(collections.c.id == collection_id)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        detail = f"There is no collection with the id {collection_id!r}"
        places = [Place("collection_id", "is the id of no collection")]
        raise CollectionNotFound(detail, places=places)
    return CollectionRecord(**row)


def list_page(tx: Tx, *, limit: int, cursor: str | None = None) -> Page[CollectionRecord]:
    """One page of collections, newest first; raises PageNotFound at "cursor"."""
    created, row_id = collections.c.created_at, collections.c.id
    query = _LISTED
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        query = query.where(after(created, row_id, position, descending=True))
    query = query.order_by(created.desc(), row_id.desc()).limit(limit + 1)
    found = [CollectionRecord(**row) for row in tx.execute(query).mappings()]
    shown = tuple(found[:limit])
    if len(found) <= limit:
        return Page(shown, None)
    return Page(shown, write_cursor(NEWEST_FIRST, Position(shown[-1].created_at, shown[-1].id)))


def total(tx: Tx) -> Total:
    """How many collections there are."""
    return total_of(tx, select(collections.c.id))


def change(
    tx: Tx, collection_id: str, *, name: str | None = None, notes: str | None = None
) -> CollectionRecord:
    """Changes name and notes; None leaves one as it is. Raises CollectionNotFound, Conflict."""
    library.lock(tx)
    get(tx, collection_id)
    if name is not None:
        _check_free(tx, name, collection_id)
    given = {"name": name, "notes": notes}
    values: dict[str, Any] = {key: value for key, value in given.items() if value is not None}
    _touch(tx, collection_id, **values)
    return get(tx, collection_id)


def remove(tx: Tx, collection_id: str) -> None:
    """Removes a collection; its clips stay. Raises CollectionNotFound."""
    get(tx, collection_id)
    tx.execute(delete(collections).where(collections.c.id == collection_id))


def add_items(tx: Tx, collection_id: str, items: Sequence[NewItem]) -> None:
    """Adds items at the end. The caller has checked that the clips exist."""
    last = tx.execute(select(func.max(collection_items.c.position)).where(_of(collection_id)))
    first = (last.scalar_one() or 0) + 1
    rows = [
        {
            "id": new_id("item"),
            "collection_id": collection_id,
            "clip_id": item.clip_id,
            "position": first + index,
            "start": item.start,
            "end": item.end,
            "notes": item.notes,
        }
        for index, item in enumerate(items)
    ]
    if rows:
        tx.execute(insert(collection_items), rows)
    _touch(tx, collection_id)


def items_page(
    tx: Tx, collection_id: str, *, limit: int, cursor: str | None = None
) -> Page[ItemRecord]:
    """One page of the items, in their order; raises PageNotFound at "cursor"."""
    query = select(collection_items).where(_of(collection_id))
    place = collection_items.c.position
    if cursor is not None:
        position = read_cursor(cursor, IN_ORDER, float)
        query = query.where(after(place, collection_items.c.id, position, descending=False))
    found = _items(tx, query.order_by(place, collection_items.c.id).limit(limit + 1))
    shown = tuple(found[:limit])
    if len(found) <= limit:
        return Page(shown, None)
    return Page(shown, write_cursor(IN_ORDER, Position(float(shown[-1].position), shown[-1].id)))


def items_of(tx: Tx, collection_id: str) -> list[ItemRecord]:
    """All items of a collection, in their order."""
    place = collection_items.c.position
    query = select(collection_items).where(_of(collection_id))
    return _items(tx, query.order_by(place, collection_items.c.id))


def get_item(tx: Tx, collection_id: str, item_id: str) -> ItemRecord:
    """The item. Raises NotFound."""
    found = _items(
        tx, select(collection_items).where(_of(collection_id), collection_items.c.id == item_id)
    )
    if not found:
        places = [Place("item_id", "is the id of no item of this collection")]
        raise NotFound(f"The collection has no item {item_id!r}", places=places)
    return found[0]


def change_item(tx: Tx, collection_id: str, item: ItemRecord) -> ItemRecord:
    """Stores the part and the notes of an item. Raises NotFound."""
    get_item(tx, collection_id, item.id)
    changed = update(collection_items).where(collection_items.c.id == item.id)
    tx.execute(changed.values(start=item.start, end=item.end, notes=item.notes))
    _touch(tx, collection_id)
    return get_item(tx, collection_id, item.id)


def remove_item(tx: Tx, collection_id: str, item_id: str) -> None:
    """Removes an item; its clip stays. Raises NotFound."""
    get_item(tx, collection_id, item_id)
    tx.execute(delete(collection_items).where(collection_items.c.id == item_id))
    _touch(tx, collection_id)


def put_in_order(tx: Tx, collection_id: str, item_ids: Sequence[str]) -> None:
    """Puts these items first, in this order; the others follow in theirs."""
    first = {item_id: place for place, item_id in enumerate(item_ids)}
    items = sorted(
        items_of(tx, collection_id),
        key=lambda item: (first.get(item.id, len(first)), item.position),
    )
    for place, item in enumerate(items, start=1):
        if item.position != place:
            moved = update(collection_items).where(collection_items.c.id == item.id)
            tx.execute(moved.values(position=place))
    _touch(tx, collection_id)


def existing(tx: Tx, collection_ids: Collection[str]) -> set[str]:
    """Those of the ids that are the id of a collection."""
    query = select(collections.c.id).where(collections.c.id.in_(list(collection_ids)))
    return set(tx.execute(query).scalars())


def clip_ids(tx: Tx, collection_ids: Collection[str]) -> tuple[str, ...]:
    """The ids of the clips that are in any of the collections, sorted."""
    query = select(collection_items.c.clip_id).where(
        collection_items.c.collection_id.in_(list(collection_ids))
    )
    return tuple(tx.execute(query.distinct().order_by(collection_items.c.clip_id)).scalars())


def texts(tx: Tx) -> Iterator[tuple[str, str, str]]:
    """The id, the name and the notes of every collection, and of every item (without a name)."""
    named = select(collections.c.id, collections.c.name, collections.c.notes)
    yield from ((row.id, row.name, row.notes) for row in tx.execute(named).all())
    noted = select(collection_items.c.id, collection_items.c.notes)
    rows = tx.execute(noted.where(collection_items.c.notes != "")).all()
    yield from ((row.id, "", row.notes) for row in rows)


def rewrite(tx: Tx, row_id: str, name: str, notes: str) -> None:
    """Stores other texts of a collection or an item. A name that is taken gets the id behind it."""
    taken = select(collections.c.id).where(collections.c.name == name, collections.c.id != row_id)
    if tx.execute(taken).first() is not None:
        name = f"{name} {row_id}"
    renamed = update(collections).where(collections.c.id == row_id)
    tx.execute(renamed.values(name=name, notes=notes))
    noted = update(collection_items).where(collection_items.c.id == row_id)
    tx.execute(noted.values(notes=notes))


_SIZE = (
    select(func.count())
    .where(collection_items.c.collection_id == collections.c.id)
    .scalar_subquery()
    .label("size")
)
_LISTED = select(collections, _SIZE)


def _of(collection_id: str) -> Any:
    return collection_items.c.collection_id == collection_id


def _items(tx: Tx, query: Any) -> list[ItemRecord]:
    return [_to_item(row) for row in tx.execute(query).mappings()]


def _to_item(row: RowMapping) -> ItemRecord:
    names = ("id", "clip_id", "position", "start", "end", "notes")
    return ItemRecord(**{name: row[name] for name in names})


def _touch(tx: Tx, collection_id: str, **values: Any) -> None:
    changed = update(collections).where(collections.c.id == collection_id)
    tx.execute(changed.values(changed_at=utc_now(), **values))


def _check_free(tx: Tx, name: str, own_id: str | None) -> None:
    holder = tx.execute(select(collections.c.id).where(collections.c.name == name)).scalar()
    if holder is not None and holder != own_id:
        raise Conflict(
            f"There is a collection with the name {name!r} already.",
            places=[Place("name", f"is the name of {holder}")],
        )
