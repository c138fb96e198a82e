"""Collections: named sets of clips or parts of clips, with an order and notes."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response
from fastapi.responses import StreamingResponse

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.guard.audited import exported
from app.api.openapi import BINARY, CollectionId, ItemId, refusals
from app.api.pieces import Pieces
from app.api.routes.export import attachment
from app.api.schemas.collection_statistics import CollectionStatistics
from app.api.schemas.collections import (
    Collection,
    CollectionExport,
    CollectionItem,
    CollectionItemList,
    CollectionItems,
    CollectionList,
    CollectionPatch,
    ItemOrder,
    ItemPatch,
    ListPage,
    NewCollection,
)
from app.errors import ClipNotReady, Conflict, ModelNotFitted, NotEnoughLabels
from app.services.collections import collections
from app.services.collections.export import export_collection
from app.services.collections.statistics import statistics

router = APIRouter(prefix="/v1/collections", tags=["collections"])
SEARCHED = (ClipNotReady, ModelNotFitted, NotEnoughLabels)

_CREATE = """\
Make a collection, empty or with items: clips or parts that are listed, all clips that pass a
filter, and the first hits of a search. `GET /v1/clips?collection=ID` lists its clips, and
`{"filter": {"collection": "ID"}}` searches among them. A clip that is deleted leaves its
collections.
"""
_EXPORT = """\
The collection as a ZIP: a file for each item, in any format, on its own skeleton or on one body for
all (`skeleton=canonical`). The names begin with the number of the item. With them come
`manifest.csv`, which an import reads again, `LICENSES.txt` with the files of each license, and
`CREDITS.txt` with sources, licenses and performers. An item that cannot be exported is left out,
and `left_out.csv` says why.
"""


@router.post(
    "",
    status_code=201,
    description=_CREATE,
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, Conflict, *SEARCHED),
)
def create_collection(lib: Lib, new: NewCollection) -> Collection:
    """Make a collection."""
    return Collection.model_validate(collections.create(lib, new.name, new.notes, new.found(lib)))


@router.get("", dependencies=[reads, quick], responses=refusals(404))
def list_collections(lib: Lib, query: Annotated[ListPage, Query()]) -> CollectionList:
    """The collections, the newest first."""
    page = collections.list_page(lib, query.limit, query.cursor)
    return CollectionList.model_validate(page)


@router.get("/{collection_id}", dependencies=[reads, quick], responses=refusals(404))
def get_collection(lib: Lib, collection_id: CollectionId) -> Collection:
    """One collection."""
    return Collection.model_validate(collections.get(lib, collection_id))


@router.patch(
    "/{collection_id}",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415, Conflict),
)
def update_collection(lib: Lib, collection_id: CollectionId, patch: CollectionPatch) -> Collection:
    """Change the name or the notes of a collection."""
    sent = patch.model_dump(exclude_unset=True)
    return Collection.model_validate(collections.change(lib, collection_id, sent))


@router.delete(
    "/{collection_id}", status_code=204, dependencies=[writes, changes], responses=refusals(404)
)
def delete_collection(lib: Lib, collection_id: CollectionId) -> None:
    """Delete a collection. Its clips stay."""
    collections.remove(lib, collection_id)


@router.get("/{collection_id}/items", dependencies=[reads, quick], responses=refusals(404))
def list_items(
    lib: Lib, collection_id: CollectionId, query: Annotated[ListPage, Query()]
) -> CollectionItemList:
    """The items of a collection, in their order."""
    page = collections.items_page(lib, collection_id, query.limit, query.cursor)
    return CollectionItemList(
        items=[CollectionItem.of(item) for item in page.items],
        next=page.next,
        total=page.total or 0,
        total_is_exact=page.total_is_exact,
    )


@router.post(
    "/{collection_id}/items",
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, *SEARCHED),
)
def add_items(lib: Lib, collection_id: CollectionId, sent: CollectionItems) -> Collection:
    """Add clips, parts, the clips of a filter or the hits of a search, behind the others."""
    added = collections.add_items(lib, collection_id, sent.found(lib))
    return Collection.model_validate(added)


@router.patch(
    "/{collection_id}/items/{item_id}",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def update_item(
    lib: Lib, collection_id: CollectionId, item_id: ItemId, patch: ItemPatch
) -> CollectionItem:
    """Change the part or the notes of an item."""
    sent = patch.model_dump(exclude_unset=True)
    return CollectionItem.of(collections.change_item(lib, collection_id, item_id, sent))


@router.delete(
    "/{collection_id}/items/{item_id}",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def remove_item(lib: Lib, collection_id: CollectionId, item_id: ItemId) -> None:
    """Take an item out of a collection. Its clip stays."""
    collections.remove_item(lib, collection_id, item_id)


@router.put(
    "/{collection_id}/order",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def order_items(lib: Lib, collection_id: CollectionId, sent: ItemOrder) -> Collection:
    """Put items first, in this order; the others follow in theirs."""
    ordered = collections.put_in_order(lib, collection_id, sent.item_ids)
    return Collection.model_validate(ordered)


@router.get(
    "/{collection_id}/statistics", dependencies=[reads, heavy], responses=refusals(404, 503)
)
def get_collection_statistics(lib: Lib, collection_id: CollectionId) -> CollectionStatistics:
    """What a collection covers: speeds, turns, directions, poses; and proposals of what is missing.

    A cell is a range of speeds at a range of turns (means over half a second, as motion matching
    needs them).
    """
    return CollectionStatistics.of(statistics(lib, collection_id))


@router.get(
    "/{collection_id}/export",
    response_class=StreamingResponse,
    description=_EXPORT,
    dependencies=[reads, exported, heavy],
    responses={
        200: {"description": "The ZIP, as an attachment.", "content": {"application/zip": BINARY}},
        **refusals(404),
    },
)
def export_collection_as_zip(
    lib: Lib, collection_id: CollectionId, query: Annotated[CollectionExport, Query()]
) -> Response:
    """The collection as a ZIP with a manifest, licenses and credits."""
    file = export_collection(
        lib,
        collection_id,
        query.format,
        skeleton=query.skeleton,
        joints=query.joints,
        unit=query.unit,
        fps=query.fps,
    )
    headers = {"Content-Disposition": attachment(file.file_name)}
    return Pieces(file.blocks, media_type="application/zip", headers=headers)
