"""Two clips compared moment by moment."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query

from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.schemas.alignment import Alignment, AlignmentQuery
from app.errors import ClipNotReady
from app.services.comparison.alignment import align_clips

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads_source])


@router.get("/alignment", dependencies=[heavy], responses=refusals(404, ClipNotReady))
def get_alignment(
    lib: Lib, clip_id: ClipId, query: Annotated[AlignmentQuery, Query()]
) -> Alignment:
    """How the clip differs from another: which joints, when, and by how many centimeters.

    Dynamic time warping finds the moments that belong together, ten times a second, however fast
    each of the two moves. The differences do not depend on place, heading and size of the bodies.
    Each part may be up to 300 s long.
    """
    return Alignment.of(align_clips(lib, *query.parts(clip_id)))
