"""Search by pose."""

from __future__ import annotations

from dataclasses import replace

from fastapi import APIRouter, Depends, Response

from app.api.bodies import require_json
from app.api.deps import Lib, reads
from app.api.guard.admission import heavy
from app.api.openapi import refusals
from app.api.schemas.pose import PoseHits, PoseSearch
from app.api.sparse import ChosenFields, clip_fields, sparse_page
from app.services.find.by_pose import find_pose

router = APIRouter(prefix="/v1/search", tags=["search"])


@router.post(
    "/pose",
    dependencies=[reads, Depends(require_json), heavy],
    response_model=PoseHits,
    responses=refusals(400, 404, 409, 413, 415),
)
def search_pose(lib: Lib, sent: PoseSearch, fields: ChosenFields = None) -> PoseHits | Response:
    """Find the clips that take a pose, and the times at which they do."""
    found = find_pose(lib, replace(sent.query(), clip_fields=clip_fields(fields)))
    return sparse_page(PoseHits, fields, found) if fields else PoseHits.model_validate(found)
