"""The motions that motion symbols generate."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response

from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.symbols import SymbolMotion, channels_json
from app.api.streams import as_json, as_octets, prefers_octets
from app.api.validators import UNCHANGED, of_one_clip
from app.errors import ClipNotReady
from app.services.views import symbol_motion

router = APIRouter(tags=["clips"], dependencies=[reads_source])


@router.get(
    "/v1/clips/{clip_id}/symbol/motion",
    response_model=SymbolMotion,
    dependencies=[of_one_clip, heavy],
    responses={200: OCTET_ANSWER, 304: UNCHANGED, **refusals(404, ClipNotReady)},
)
def get_symbol_motion(lib: Lib, request: Request, clip_id: ClipId) -> Response:
    """The mean trajectory of the clip's motion symbol.

    It is shown as channels with their standard deviations, and as a motion of the 13 joint roles.
    `Accept: application/octet-stream` returns only the motion.
    """
    view = symbol_motion.symbol_motion(lib, clip_id)
    if prefers_octets(request):
        return as_octets(view.motion)
    return as_json(view.motion, {"states": view.states}, trailing=channels_json(view))
