"""Clips drawn from few dimensions, and clips as pictures that move."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from app.api.deps import Lib, reads
from app.api.guard.admission import heavy
from app.api.openapi import ClipId, refusals
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.low_dimensional import (
    AnimationQuery,
    LowDimensional,
    LowDimensionalFigures,
    LowDimensionalQuery,
)
from app.api.streams import as_json, as_octets, wants_octets
from app.services.views import low_dimensional
from app.services.views.animations import animation_svg

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads])

DESCRIPTION = """\
The motion projected onto the first K' principal axes of a few poses and drawn again (Perera
2009, equations 4 to 11), beside what that keeps and costs. The poses are the keyposes of the
clip, or of `model_clips`; or, with `basis=uniform`, as many at equal times.

`variance_kept` is the share of the variance of the model's own poses. It is no measure of the
motion: keyposes differ in fewer ways than other poses, so they keep more of it, and may still
draw the motion worse. `error` says how far off the motion is.

`implausible` counts poses that no body takes, for the motion and for the original: a knee or
elbow folded beyond 160 degrees (`folded`), a knee bent forward by 10 or an elbow backward by
25 (`bent_backward`), a head 70 degrees out of the trunk's line (`turned_away`), a hand within
0.07 body lengths of the line from hips to neck (`in_trunk`).

`Accept: application/octet-stream` gives the positions alone, as `/motion` does.
"""
SVG_ANSWER = {
    "description": "A picture that moves by itself (SMIL, no script).",
    "content": {"image/svg+xml": {"schema": {"type": "string"}}},
}


@router.get(
    "/low-dimensional",
    response_model=LowDimensional,
    description=DESCRIPTION,
    dependencies=[heavy],
    responses={200: OCTET_ANSWER, **refusals(404, 409)},
)
def get_low_dimensional(
    lib: Lib, request: Request, clip_id: ClipId, wanted: Annotated[LowDimensionalQuery, Query()]
) -> Response:
    """The clip drawn from few dimensions."""
    view = low_dimensional.view(lib, clip_id, wanted.as_reduction(), wanted.fps)
    if wants_octets(request):
        return as_octets(view.motion)
    told = LowDimensionalFigures.of(view).members()
    return as_json(view.motion, told, {"eigen_motion": view.eigen_motion})


@router.get(
    "/animation.svg",
    dependencies=[heavy],
    response_class=Response,
    responses={200: SVG_ANSWER, **refusals(404, 409)},
)
def get_animation(
    lib: Lib, clip_id: ClipId, wanted: Annotated[AnimationQuery, Query()]
) -> Response:
    """The clip as a stick figure that moves; drawn from few dimensions where `dimensions` is
    given. Left limbs are orange, right ones blue; marks on the floor are half a metre apart."""
    picture = animation_svg(lib, clip_id, wanted.reduction_if_any(), wanted.start, wanted.end)
    return Response(picture, media_type="image/svg+xml")
