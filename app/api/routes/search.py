"""Searches by example and by words."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import is_multipart, read_form, read_json, require_json
from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.hit_pages import ChosenFields, HitPage
from app.api.openapi import body, refusals
from app.api.queries import QUERY_FILES, source_of
from app.api.schemas.search import MotionHits, MotionSearch, MotionSearchForm, WordHits, WordSearch
from app.errors import ClipNotReady, ModelNotFitted, NotEnoughLabels
from app.services.find import find
from app.services.find.queries import MotionQuery

router = APIRouter(prefix="/v1/search", tags=["search"])

_MOTION_EXAMPLES = {
    "like a stored clip": {"clip_id": "CLIP_ID", "limit": 5},
    "like a part of it, among walks": {
        "clip_id": "CLIP_ID",
        "start": 0.5,
        "end": 1.5,
        "method": "dtw",
        "filter": {"task": ["walk"]},
    },
    "parts of clips like a part of it": {
        "clip_id": "CLIP_ID",
        "start": 0.5,
        "end": 2.5,
        "scope": "windows",
    },
    "steps like one of its steps": {"clip_id": "CLIP_ID", "segment": 0, "scope": "segments"},
}


async def _motion_query(request: Request) -> MotionQuery:
    if not is_multipart(request):
        sent = await read_json(request, MotionSearch)
        return sent.query(sent.source(), sent.segment)
    form, uploads = await read_form(request, MotionSearchForm, QUERY_FILES)
    return form.query(source_of(form, uploads))


@router.post(
    "/motion",
    dependencies=[
        reads_source,
        Depends(_motion_query),
        heavy,
    ],  # a slot only after the form
    responses=refusals(400, 404, 413, 415, 503, 507, ClipNotReady, ModelNotFitted),
    response_model=MotionHits,
    openapi_extra=body(
        model=MotionSearch,
        examples=_MOTION_EXAMPLES,
        form=MotionSearchForm,
        files=QUERY_FILES,
    ),
)
def search_motion(
    lib: Lib, query: Annotated[MotionQuery, Depends(_motion_query)], fields: ChosenFields = None
) -> Response:
    """Find motions like a stored clip, a part of one, or an uploaded file.

    With scope `windows`, find parts of clips, with their start and end. With scope `segments`,
    find motions from one keypose to the next.
    """
    page = HitPage.of(MotionHits, fields)
    return page.answer(find.find_motion(lib, replace(query, clip_fields=page.clip_fields)))


@router.post(
    "/words",
    dependencies=[reads_source, Depends(require_json), heavy],
    response_model=WordHits,
    responses=refusals(400, 404, 413, 415, ModelNotFitted, NotEnoughLabels),
)
def search_words(lib: Lib, sent: WordSearch, fields: ChosenFields = None) -> Response:
    """Find motions for words, phrases or sentences. The most probable motion comes first.

    The `score` of a hit is a probability, in both modes.
    """
    page = HitPage.of(WordHits, fields)
    return page.answer(find.find_words(lib, replace(sent.query(), clip_fields=page.clip_fields)))
