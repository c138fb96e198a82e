"""Search by pose."""

from __future__ import annotations

from dataclasses import replace
from typing import Annotated

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import is_multipart, read_form, read_json
from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.hit_pages import ChosenFields, HitPage
from app.api.openapi import body, refusals
from app.api.queries import QUERY_FILES, source_of
from app.api.schemas.pose import A_POSE, PoseHits, PoseSearch, PoseSearchForm
from app.errors import ClipNotReady
from app.services.find.by_pose import find_pose
from app.services.find.queries import PoseQuery

router = APIRouter(prefix="/v1/search", tags=["search"])

_EXAMPLES = {
    "the pose of a stored clip at a time": {"clip_id": "CLIP_ID", "time": 0.5, "limit": 5},
    "13 positions: arms stretched out": {"positions": A_POSE, "places": "all"},
}


async def _pose_query(request: Request) -> PoseQuery:
    if not is_multipart(request):
        return (await read_json(request, PoseSearch)).query()
    form, uploads = await read_form(request, PoseSearchForm, QUERY_FILES)
    return form.query_of(source_of(form, uploads), form.time)


@router.post(
    "/pose",
    dependencies=[
        reads_source,
        Depends(_pose_query),
        heavy,
    ],  # a slot only after the form
    response_model=PoseHits,
    responses=refusals(400, 404, 413, 415, 503, 507, ClipNotReady),
    openapi_extra=body(
        model=PoseSearch,
        examples=_EXAMPLES,
        form=PoseSearchForm,
        files=QUERY_FILES,
        needed=["time"],
    ),
)
def search_pose(
    lib: Lib, query: Annotated[PoseQuery, Depends(_pose_query)], fields: ChosenFields = None
) -> Response:
    """Find the clips that take a pose, and the times at which they do.

    The pose is that of a stored clip or of an uploaded file at a time, or 13 positions.
    """
    page = HitPage.of(PoseHits, fields)
    return page.answer(find_pose(lib, replace(query, clip_fields=page.clip_fields)))
