"""Views of a clip: its motion, descriptor and picture."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response

from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.openapi import BINARY, ClipId, refusals
from app.api.schemas.views import (
    Descriptor,
    MatrixParameters,
    Motion,
    MotionQueryParameters,
    SlicesParameters,
)
from app.api.streams import OCTETS, as_json, as_octets, prefers_octets
from app.api.validators import UNCHANGED, of_one_clip
from app.errors import ClipNotReady
from app.services.views import views, volumes

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads_source])

_SHAPE = {
    "description": "`frames,joints,3`, with octet streams.",
    "schema": {"type": "string"},
    "required": False,
}
OCTET_ANSWER = {"content": {OCTETS: BINARY}, "headers": {"X-Shape": _SHAPE}}


@router.get(
    "/motion",
    response_model=Motion,
    dependencies=[of_one_clip, heavy],
    responses={
        200: OCTET_ANSWER,
        304: UNCHANGED,
        **refusals(404, ClipNotReady),
    },
)
def get_motion(
    lib: Lib, request: Request, clip_id: ClipId, query: Annotated[MotionQueryParameters, Query()]
) -> Response:
    """Joint positions: JSON, or little-endian float32 for `Accept: application/octet-stream`."""
    view = views.motion(lib, clip_id, query.fps, query.joints)
    return as_octets(view) if prefers_octets(request) else as_json(view)


@router.get(
    "/descriptor",
    dependencies=[of_one_clip, heavy],
    responses={304: UNCHANGED, **refusals(404, ClipNotReady)},
)
def get_descriptor(lib: Lib, clip_id: ClipId) -> Descriptor:
    """The arrays by which the clip is compared with others."""
    return Descriptor.of(views.descriptor(lib, clip_id))


@router.get(
    "/thumbnail.svg",
    dependencies=[of_one_clip, heavy],
    response_class=Response,
    responses={
        200: {
            "description": "A few stick figures over time.",
            "content": {"image/svg+xml": BINARY},
        },
        304: UNCHANGED,
        **refusals(404, ClipNotReady),
    },
)
def get_thumbnail(lib: Lib, clip_id: ClipId) -> Response:
    """The clip as a small picture."""
    return Response(views.thumbnail_svg(lib, clip_id), media_type="image/svg+xml")


def _picture(description: str) -> dict[int | str, dict[str, Any]]:
    return {
        200: {"description": description, "content": {"image/svg+xml": BINARY}},
        304: UNCHANGED,
        **refusals(404, ClipNotReady),
    }


@router.get(
    "/ssm.svg",
    dependencies=[of_one_clip, heavy],
    response_class=Response,
    responses=_picture("A matrix of 13 x 13 cells, with the names of the joints."),
)
def get_self_similarity(
    lib: Lib, clip_id: ClipId, query: Annotated[MatrixParameters, Query()]
) -> Response:
    """The self-similarity matrix of one pose: the distances between its joints.

    Figure 3 of Sun 2011. Distances are in body lengths; the darkest cell is the largest distance of
    the clip.
    """
    picture = volumes.ssm_svg(lib, clip_id, query.time, query.options())
    return Response(picture, media_type="image/svg+xml")


@router.get(
    "/msv.svg",
    dependencies=[of_one_clip, heavy],
    response_class=Response,
    responses=_picture("Slices of the volume, one behind the other, with their times."),
)
def get_motion_volume(
    lib: Lib, clip_id: ClipId, query: Annotated[SlicesParameters, Query()]
) -> Response:
    """The motion volume: the self-similarity matrices of the clip over time.

    Figure 5 of Sun 2011.
    """
    picture = volumes.msv_svg(lib, clip_id, query.slices, query.options())
    return Response(picture, media_type="image/svg+xml")
