"""Saved searches: run them again, and see which hits came since."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, Query, Response

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.hit_pages import HitPage
from app.api.openapi import SearchId, refusals
from app.api.schemas.collections import ListPage
from app.api.schemas.composed_search import ComposedHits
from app.api.schemas.saved_searches import (
    NewHits,
    NewSearch,
    SavedSearch,
    SavedSearchList,
    SearchPage,
    SearchPatch,
    as_query,
    as_stored,
    first_page,
)
from app.errors import ClipNotReady, Conflict, ModelNotFitted, NotEnoughLabels
from app.services.find.by_parts import find_by_parts
from app.services.searches import searches

router = APIRouter(prefix="/v1/searches", tags=["searches"])
SEARCHED = (ClipNotReady, ModelNotFitted, NotEnoughLabels)


@router.post(
    "",
    status_code=201,
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, Conflict, *SEARCHED),
)
def save_search(lib: Lib, new: NewSearch) -> SavedSearch:
    """Save a search of `POST /v1/search` under a name. Its present hits count as seen."""
    saved = searches.save(lib, new.name, first_page(new.query), as_stored(new.query))
    return SavedSearch.model_validate(saved)


@router.get("", dependencies=[reads, quick], responses=refusals(404))
def list_searches(lib: Lib, query: Annotated[ListPage, Query()]) -> SavedSearchList:
    """The saved searches, the newest first."""
    page = searches.list_page(lib, query.limit, query.cursor)
    return SavedSearchList.model_validate(page)


@router.get("/{search_id}", dependencies=[reads, quick], responses=refusals(404))
def get_search(lib: Lib, search_id: SearchId) -> SavedSearch:
    """One saved search."""
    return SavedSearch.model_validate(searches.get(lib, search_id))


@router.patch(
    "/{search_id}",
    dependencies=[writes, Depends(require_json), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, Conflict, *SEARCHED),
)
def update_search(lib: Lib, search_id: SearchId, patch: SearchPatch) -> SavedSearch:
    """Change the name or the query of a saved search."""
    query = patch.query
    changed = searches.change(
        lib,
        search_id,
        name=patch.name,
        query=None if query is None else first_page(query),
        as_sent=None if query is None else as_stored(query),
    )
    return SavedSearch.model_validate(changed)


@router.delete(
    "/{search_id}", status_code=204, dependencies=[writes, changes], responses=refusals(404)
)
def delete_search(lib: Lib, search_id: SearchId) -> None:
    """Delete a saved search."""
    searches.remove(lib, search_id)


@router.get(
    "/{search_id}/hits",
    dependencies=[reads, heavy],
    response_model=ComposedHits,
    responses=refusals(404, 503, *SEARCHED),
)
def run_search(lib: Lib, search_id: SearchId, page: Annotated[SearchPage, Query()]) -> Response:
    """Run a saved search again. It does not count as looked at: see `POST .../seen`."""
    saved = searches.get(lib, search_id)
    shown = HitPage.of(ComposedHits, page.fields)
    sent = page.model_dump(exclude={"fields"}, exclude_none=True)
    query = as_query(saved, **sent).query()
    return shown.answer(find_by_parts(lib, replace(query, clip_fields=shown.clip_fields)))


@router.get(
    "/{search_id}/new", dependencies=[reads, heavy], responses=refusals(404, 503, *SEARCHED)
)
def get_new_hits(lib: Lib, search_id: SearchId) -> NewHits:
    """The hits that came since a saved search was last looked at.

    A hit is new if it was none then, and its clip came or was changed since. The answer does not
    count as a look: `POST .../seen` does.
    """
    saved = searches.get(lib, search_id)
    found = searches.new_hits(lib, saved, as_query(saved).query())
    return NewHits.model_validate(
        {"seen_at": saved.seen_at, "library_version": found.library_version, "items": found.items}
    )


@router.post(
    "/{search_id}/seen",
    dependencies=[writes, heavy],
    responses=refusals(404, 503, 507, *SEARCHED),
)
def mark_search_seen(lib: Lib, search_id: SearchId) -> SavedSearch:
    """Count the present hits of a saved search as seen: they are not new any more."""
    saved = searches.get(lib, search_id)
    return SavedSearch.model_validate(searches.look_at(lib, search_id, as_query(saved).query()))
