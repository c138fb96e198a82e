"""Searches by several parts, and why a clip is a hit of one."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import is_multipart, read_form, read_json
from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.hit_pages import ChosenFields, HitPage
from app.api.openapi import body, refusals
from app.api.queries import QUERY_FILES, file_of
from app.api.schemas.composed_search import ComposedHits, ComposedSearch, ComposedSearchForm
from app.api.schemas.why import HitReasons, WhySearch, WhySearchForm
from app.errors import ClipNotReady, ModelNotFitted, NotEnoughLabels
from app.services.comparison.why import explain_hit
from app.services.find.by_parts import find_by_parts
from app.services.find.queries import ComposedQuery

router = APIRouter(prefix="/v1/search", tags=["search"])

_COMPOSED_EXAMPLES = {
    "like two motions": {
        "examples": [
            {"clip_id": "CLIP_ID"},
            {"clip_id": "CLIP_ID", "start": 0.5, "end": 1.5, "weight": 0.5},
        ],
        "limit": 5,
    },
    "like one motion, not like another, among walks": {
        "examples": [
            {"clip_id": "CLIP_ID"},
            {"clip_id": "CLIP_ID", "end": 1, "against": True},
        ],
        "filter": {"task": ["walk"]},
    },
    "legs like those of a motion, grouped by person": {
        "examples": [{"clip_id": "CLIP_ID", "body_part": "legs"}],
        "group_by": "person",
        "facets": ["task", "duration"],
    },
    "from one pose to another, in a rhythm": {
        "poses": {
            "sequence": [{"clip_id": "CLIP_ID", "time": 0.2}, {"clip_id": "CLIP_ID", "time": 0.5}]
        },
        "rhythm": {"cycles_per_minute": 55, "tolerance": 0.2},
        "filter": {"where": {"any_of": [{"task": "walk"}, {"none_of": [{"word": "tired"}]}]}},
    },
    "like a motion, and of these words": {
        "examples": [{"clip_id": "CLIP_ID"}],
        "words": ["wave", "-tired"],
    },
}


async def _composed_query(request: Request) -> ComposedQuery:
    if not is_multipart(request):
        return (await read_json(request, ComposedSearch)).query()
    form, uploads = await read_form(request, ComposedSearchForm, QUERY_FILES)
    return form.query(file_of(uploads, "file"), file_of(uploads, "skeleton"))


@router.post(
    "",
    dependencies=[reads_source, Depends(_composed_query), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, ClipNotReady, ModelNotFitted, NotEnoughLabels),
    response_model=ComposedHits,
    openapi_extra=body(
        model=ComposedSearch,
        examples=_COMPOSED_EXAMPLES,
        form=ComposedSearchForm,
        files=QUERY_FILES,
    ),
)
def search_parts(
    lib: Lib, query: Annotated[ComposedQuery, Depends(_composed_query)], fields: ChosenFields = None
) -> Response:
    """Find motions by several parts together, for something or against it.

    Parts are examples, words, poses in order, and a rhythm. A clip is a good hit if it is like
    every example that is for something, carries the words, and is like no example that is against
    something. Each hit tells what each part contributed.
    """
    page = HitPage.of(ComposedHits, fields)
    return page.answer(find_by_parts(lib, replace(query, clip_fields=page.clip_fields)))


async def _explained(request: Request) -> tuple[ComposedQuery, str]:
    if not is_multipart(request):
        sent = await read_json(request, WhySearch)
        return sent.query(), sent.hit
    form, uploads = await read_form(request, WhySearchForm, QUERY_FILES)
    return form.query(file_of(uploads, "file"), file_of(uploads, "skeleton")), form.hit


@router.post(
    "/why",
    dependencies=[reads_source, Depends(_explained), heavy],
    responses=refusals(400, 404, 413, 415, 503, 507, ClipNotReady, ModelNotFitted, NotEnoughLabels),
    openapi_extra=body(
        model=WhySearch,
        examples={
            "a hit of an example and a word": {
                "examples": [{"clip_id": "CLIP_ID"}],
                "words": ["walk"],
                "hit": "CLIP_ID",
            }
        },
        form=WhySearchForm,
        files=QUERY_FILES,
    ),
)
def explain_search(
    lib: Lib, asked: Annotated[tuple[ComposedQuery, str], Depends(_explained)]
) -> HitReasons:
    """Why a clip is a hit of a search by several parts: what each part says, when and where.

    The body is that of `POST /v1/search`, and `hit`. For each example, both motions are aligned:
    times that belong together, and how far each joint is apart. For words, a curve over time.
    """
    query, hit = asked
    return HitReasons.of(explain_hit(lib, query, hit))
