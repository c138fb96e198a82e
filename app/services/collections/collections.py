"""Collections: make, list, change and remove them and their items."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from app.errors import BadField
from app.kinedex_error import Place
from app.services import fields
from app.services.fields import bad_field
from app.services.library.library import Library
from app.store import audit
from app.store import collections as stored
from app.store.clips import repository as clips
from app.store.clips.record import ClipRecord
from app.store.collections import CollectionRecord, ItemRecord, NewItem
from app.store.database.engine import Tx
from app.store.database.paging import Page

MAX_ITEMS = 10_000
"""Items of one collection."""
MAX_NOTES = 5_000
"""Characters of the notes of a collection or an item."""


@dataclass(frozen=True, slots=True)
class Item:
    """An item of a collection, with its clip."""

    record: ItemRecord
    clip: ClipRecord

    @property
    def seconds(self) -> float:
        """The duration of the part; 0 for a clip that is not analyzed."""
        whole = self.clip.duration or 0.0
        end = whole if self.record.end is None else min(self.record.end, whole)
        return max(end - (self.record.start or 0.0), 0.0)


def create(
    lib: Library, name: str, notes: str = "", items: Sequence[NewItem] = ()
) -> CollectionRecord:
    """Make a collection. Raises BadField, Conflict if another one has the name."""
    tidy_name, tidy_notes = _name(name), checked_notes("notes", notes)
    with lib.store.write() as tx:
        made = stored.add(tx, tidy_name, tidy_notes)
        audit.note(collection_id=made.id, items=len(items))
        _add(tx, made, items)
        return stored.get(tx, made.id)


def get(lib: Library, collection_id: str) -> CollectionRecord:
    """A collection by id. Raises CollectionNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, collection_id)


def list_page(lib: Library, limit: int, cursor: str | None = None) -> Page[CollectionRecord]:
    """One page of collections, newest first. Raises PageNotFound for a bad cursor."""
    with lib.store.read() as tx:
        return stored.list_page(tx, limit=limit, cursor=cursor).counted(stored.total(tx))


def change(lib: Library, collection_id: str, changes: Mapping[str, Any]) -> CollectionRecord:
    """Change name or notes. Raises CollectionNotFound, BadField, Conflict."""
    tidy: dict[str, str] = {}
    if "name" in changes:
        tidy["name"] = _name(changes["name"])
    if "notes" in changes:
        tidy["notes"] = checked_notes("notes", changes["notes"] or "")
    with lib.store.write() as tx:
        audit.note(fields=sorted(tidy))
        return stored.change(tx, collection_id, **tidy)


def remove(lib: Library, collection_id: str) -> None:
    """Remove a collection; its clips stay. Raises CollectionNotFound."""
    lib.store.write_even_when_full(lambda tx: stored.remove(tx, collection_id))


def add_items(lib: Library, collection_id: str, items: Sequence[NewItem]) -> CollectionRecord:
    """Add items at the end. Raises CollectionNotFound, and BadField for an item that is no clip or
    no part of its clip, and for too many."""
    with lib.store.write() as tx:
        audit.note(items=len(items))
        _add(tx, stored.get(tx, collection_id), items)
        return stored.get(tx, collection_id)


def items_page(
    lib: Library, collection_id: str, limit: int, cursor: str | None = None
) -> Page[Item]:
    """One page of items in their order. Raises CollectionNotFound, PageNotFound."""
    with lib.store.read() as tx:
        size = stored.get(tx, collection_id).size
        page = stored.items_page(tx, collection_id, limit=limit, cursor=cursor)
        return Page(tuple(_with_clips(tx, page.items)), page.next, size)


def all_items(lib: Library, collection_id: str) -> list[Item]:
    """All items in their order. Raises CollectionNotFound."""
    with lib.store.read() as tx:
        stored.get(tx, collection_id)
        return _with_clips(tx, stored.items_of(tx, collection_id))


def change_item(lib: Library, collection_id: str, item_id: str, changes: Mapping[str, Any]) -> Item:
    """Change start, end or notes of an item. Raises CollectionNotFound, NotFound, BadField."""
    with lib.store.write() as tx:
        stored.get(tx, collection_id)
        before = stored.get_item(tx, collection_id, item_id)
        now = replace(before, **{name: changes[name] for name in changes})
        now = replace(now, notes=now.notes or "")
        clip = clips.get(tx, now.clip_id)
        _check_item(now, clip, "")
        changed = stored.change_item(tx, collection_id, now)
        return Item(changed, clip)


def remove_item(lib: Library, collection_id: str, item_id: str) -> None:
    """Remove an item; its clip stays. Raises CollectionNotFound, NotFound."""

    def remove_one(tx: Tx) -> None:
        stored.get(tx, collection_id)
        stored.remove_item(tx, collection_id, item_id)

    lib.store.write_even_when_full(remove_one)


def put_in_order(lib: Library, collection_id: str, item_ids: Sequence[str]) -> CollectionRecord:
    """Put these items first, in this order. Raises CollectionNotFound, and BadField for the id of
    no item."""
    with lib.store.write() as tx:
        stored.get(tx, collection_id)
        known = {item.id for item in stored.items_of(tx, collection_id)}
        places = [
            Place(f"item_ids.{index}", "is the id of no item of this collection")
            for index, item_id in enumerate(item_ids)
            if item_id not in known
        ]
        if places:
            raise BadField("The order names items that are not in it.", places=places)
        stored.put_in_order(tx, collection_id, item_ids)
        return stored.get(tx, collection_id)


def _add(tx: Tx, collection: CollectionRecord, items: Sequence[NewItem]) -> None:
    if collection.size + len(items) > MAX_ITEMS:
        raise bad_field("items", f"a collection has at most {MAX_ITEMS} items")
    found = clips.get_many(tx, dict.fromkeys(item.clip_id for item in items))
    for index, item in enumerate(items):
        clip = found.get(item.clip_id)
        if clip is None:
            raise bad_field(f"items.{index}.clip_id", "is the id of no clip")
        _check_item(item, clip, f"items.{index}.")
    stored.add_items(tx, collection.id, items)


def _check_item(item: NewItem, clip: ClipRecord, place: str) -> None:
    checked_notes(f"{place}notes", item.notes)
    for name, value in (("start", item.start), ("end", item.end)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise bad_field(f"{place}{name}", "must be zero or more seconds")
    end = clip.duration if item.end is None else item.end
    if end is not None and end <= (item.start or 0.0):
        raise bad_field(f"{place}end", "must be after the start")
    if clip.duration is not None and (item.start or 0.0) >= clip.duration:
        raise bad_field(f"{place}start", f"the clip ends at {clip.duration:.3f} s")


def _with_clips(tx: Tx, items: Sequence[ItemRecord]) -> list[Item]:
    found = clips.get_many(tx, dict.fromkeys(item.clip_id for item in items))
    return [Item(item, found[item.clip_id]) for item in items if item.clip_id in found]


def _name(value: str) -> str:
    name = fields.text("name", value)
    if name is None:
        raise bad_field("name", "must not be empty")
    return name


def checked_notes(field: str, value: str) -> str:
    """Notes in Unicode's NFC form; they may have several lines. Raises BadField."""
    tidy = unicodedata.normalize("NFC", value).strip()
    if len(tidy) > MAX_NOTES:
        raise bad_field(field, f"must not be longer than {MAX_NOTES} characters")
    if fields.holds_control(tidy.replace("\n", " ").replace("\r", " ").replace("\t", " ")):
        raise bad_field(field, fields.NO_CONTROL)
    return tidy
