"""Calls: collections. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from kinedex.call import Call, nothing, path_of, read_bytes, record
from kinedex.sent import UNSET, Unset, corrections, given

if TYPE_CHECKING:
    from kinedex.types.bodies import CollectionItemForm, ComposedSearch, Filter
    from kinedex.types.choices import ExportFormat, ExportJoints, ExportSkeleton, ExportUnit
    from kinedex.types.collection_statistics import CollectionStatistics
    from kinedex.types.collections import (
        Collection,
        CollectionItem,
        CollectionItemList,
        CollectionList,
    )


def list_collections(
    *, limit: int | None = None, cursor: str | None = None
) -> Call[CollectionList]:
    """The collections, the newest first.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.collections import CollectionList

    return Call(
        "list_collections",
        "GET",
        "/v1/collections",
        record(CollectionList),
        query=given(limit=limit, cursor=cursor),
    )


def create_collection(
    name: str,
    *,
    items: Sequence[CollectionItemForm] | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    search: ComposedSearch | None = None,
    notes: str | None = None,
) -> Call[Collection]:
    """Make a collection, empty or with items: clips or parts that are listed, all clips that pass a
    filter, and the first hits of a search. `GET /v1/clips?collection=ID` lists its clips, and
    `{"filter": {"collection": "ID"}}` searches among them. A clip that is deleted leaves its
    collections.

    filter: All ready clips that pass it.
    search: The first hits of this search, the best first: its `limit` of them.
    notes: Default: .
    """
    from kinedex.types.collections import Collection

    return Call(
        "create_collection",
        "POST",
        "/v1/collections",
        record(Collection),
        json=given(items=items, filter=filter, search=search, name=name, notes=notes),
    )


def get_collection(collection_id: str) -> Call[Collection]:
    """One collection."""
    from kinedex.types.collections import Collection

    return Call(
        "get_collection",
        "GET",
        path_of("/v1/collections/{collection_id}", collection_id=collection_id),
        record(Collection),
    )


def update_collection(
    collection_id: str, *, name: str | Unset | None = UNSET, notes: str | Unset | None = UNSET
) -> Call[Collection]:
    """Change the name or the notes of a collection.

    notes: null removes them.
    """
    from kinedex.types.collections import Collection

    return Call(
        "update_collection",
        "PATCH",
        path_of("/v1/collections/{collection_id}", collection_id=collection_id),
        record(Collection),
        json=corrections(name=name, notes=notes),
    )


def delete_collection(collection_id: str) -> Call[None]:
    """Delete a collection. Its clips stay."""
    return Call(
        "delete_collection",
        "DELETE",
        path_of("/v1/collections/{collection_id}", collection_id=collection_id),
        nothing,
    )


def list_items(
    collection_id: str, *, limit: int | None = None, cursor: str | None = None
) -> Call[CollectionItemList]:
    """The items of a collection, in their order.

    limit: Maximum number of items in all; None lists all.
    cursor: Where the list starts: `next` of an earlier page.
    """
    from kinedex.types.collections import CollectionItemList

    return Call(
        "list_items",
        "GET",
        path_of("/v1/collections/{collection_id}/items", collection_id=collection_id),
        record(CollectionItemList),
        query=given(limit=limit, cursor=cursor),
    )


def add_items(
    collection_id: str,
    *,
    items: Sequence[CollectionItemForm] | None = None,
    filter: Filter | Mapping[str, Any] | None = None,
    search: ComposedSearch | None = None,
) -> Call[Collection]:
    """Add clips, parts, the clips of a filter or the hits of a search, behind the others.

    filter: All ready clips that pass it.
    search: The first hits of this search, the best first: its `limit` of them.
    """
    from kinedex.types.collections import Collection

    return Call(
        "add_items",
        "POST",
        path_of("/v1/collections/{collection_id}/items", collection_id=collection_id),
        record(Collection),
        json=given(items=items, filter=filter, search=search),
    )


def update_item(
    collection_id: str,
    item_id: str,
    *,
    start: float | Unset | None = UNSET,
    end: float | Unset | None = UNSET,
    notes: str | Unset | None = UNSET,
) -> Call[CollectionItem]:
    """Change the part or the notes of an item.

    start: null: the start of the clip.
    end: null: the end of the clip.
    notes: null removes them.
    """
    from kinedex.types.collections import CollectionItem

    return Call(
        "update_item",
        "PATCH",
        path_of(
            "/v1/collections/{collection_id}/items/{item_id}",
            collection_id=collection_id,
            item_id=item_id,
        ),
        record(CollectionItem),
        json=corrections(start=start, end=end, notes=notes),
    )


def remove_item(collection_id: str, item_id: str) -> Call[None]:
    """Take an item out of a collection. Its clip stays."""
    return Call(
        "remove_item",
        "DELETE",
        path_of(
            "/v1/collections/{collection_id}/items/{item_id}",
            collection_id=collection_id,
            item_id=item_id,
        ),
        nothing,
    )


def order_items(collection_id: str, item_ids: Sequence[str]) -> Call[Collection]:
    """Put items first, in this order; the others follow in theirs."""
    from kinedex.types.collections import Collection

    return Call(
        "order_items",
        "PUT",
        path_of("/v1/collections/{collection_id}/order", collection_id=collection_id),
        record(Collection),
        json=given(item_ids=item_ids),
    )


def get_collection_statistics(collection_id: str) -> Call[CollectionStatistics]:
    """What a collection covers: speeds, turns, directions, poses; and proposals of what is missing.

    A cell is a range of speeds at a range of turns (means over half a second, as motion matching
    needs them).
    """
    from kinedex.types.collection_statistics import CollectionStatistics

    return Call(
        "get_collection_statistics",
        "GET",
        path_of("/v1/collections/{collection_id}/statistics", collection_id=collection_id),
        record(CollectionStatistics),
    )


def export_collection_as_zip(
    collection_id: str,
    format: ExportFormat,
    *,
    skeleton: ExportSkeleton | None = None,
    joints: ExportJoints | None = None,
    unit: ExportUnit | None = None,
    fps: float | None = None,
) -> Call[bytes]:
    """The collection as a ZIP: a file for each item, in any format, on its own skeleton or on one
    body for all (`skeleton=canonical`). The names begin with the number of the item. With them
    come `manifest.csv`, which an import reads again, `LICENSES.txt` with the files of each
    license, and `CREDITS.txt` with sources, licenses and performers. An item that cannot be
    exported is left out, and `left_out.csv` says why.

    skeleton: own: each clip's joints; canonical: one body for all. Default: own.
    joints: Default: all.
    fps: Default: each clip's own rate.
    """
    return Call(
        "export_collection_as_zip",
        "GET",
        path_of("/v1/collections/{collection_id}/export", collection_id=collection_id),
        read_bytes,
        query=given(format=format, skeleton=skeleton, joints=joints, unit=unit, fps=fps),
        accept="*/*",
    )
