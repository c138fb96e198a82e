"""The segments of a clip: each is the motion from one keypose to the next."""

from __future__ import annotations

from fastapi import APIRouter

from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.segments import SegmentList
from app.errors import ClipNotReady
from app.services.views.segments import list_segments

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads_source])


@router.get("/segments", dependencies=[heavy], responses=refusals(404, ClipNotReady))
def get_segments(lib: Lib, clip_id: ClipId) -> SegmentList:
    """The motions from each keypose to the next, and the sequences of them that repeat.

    If a person named keyposes, they replace the keyposes that Kinedex finds. Search segments with
    `POST /v1/search/motion` and `"scope": "segments"`, with `segment` or any part of a clip.
    """
    return SegmentList.model_validate(list_segments(lib, clip_id))
