"""Low-dimensional motions of clips, and animated pictures of clips."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request, Response

from app.api.deps import Lib, reads_source
from app.api.guard.admission import heavy
from app.api.openapi import BINARY, ClipId, refusals
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.low_dimensional import (
    AnimationQuery,
    LowDimensional,
    LowDimensionalFigures,
    LowDimensionalQuery,
)
from app.api.streams import as_json, as_octets, prefers_octets
from app.api.validators import UNCHANGED, of_one_clip
from app.errors import ClipNotReady, NotEnoughKeyposes
from app.services.views import low_dimensional
from app.services.views.animations import animation_svg

router = APIRouter(prefix="/v1/clips/{clip_id}", tags=["clips"], dependencies=[reads_source])

DESCRIPTION = """\
The motion is projected onto the first K' principal axes of a few poses and then reconstructed
(Perera 2009, equations 4 to 11). The answer also has the errors of this reconstruction. The poses
are the keyposes of the clip, or of `model_clips`. With `basis=uniform` they are the same number of
poses at equal intervals.

`variance_kept` is the share of the variance of the model's own poses. It does not measure the
motion: keyposes vary less than other poses, so the axes keep a larger share of their variance, but
they may reconstruct the motion worse. `error` is the distance from the original motion.

`implausible` counts poses that no body can take, for the motion and for the original: a knee or
elbow folded by more than 160 degrees (`folded`), a knee bent forward by 10 or an elbow backward by
25 degrees (`bent_backward`), a head turned 70 degrees away from the line of the trunk
(`turned_away`), a hand within 0.07 body lengths of the line from hips to neck (`in_trunk`).

`Accept: application/octet-stream` returns only the positions, as `/motion` does.
"""
SVG_ANSWER = {
    "description": "An animated picture (SMIL, no script).",
    "content": {"image/svg+xml": BINARY},
}


@router.get(
    "/low-dimensional",
    response_model=LowDimensional,
    description=DESCRIPTION,
    dependencies=[heavy],
    responses={200: OCTET_ANSWER, **refusals(404, ClipNotReady, NotEnoughKeyposes)},
)
def get_low_dimensional(
    lib: Lib, request: Request, clip_id: ClipId, query: Annotated[LowDimensionalQuery, Query()]
) -> Response:
    """The low-dimensional motion of a clip."""
    view = low_dimensional.view(lib, clip_id, query.as_reduction(), query.fps)
    if prefers_octets(request):
        return as_octets(view.motion)
    figures = LowDimensionalFigures.of(view).model_dump(mode="json")
    return as_json(view.motion, figures, {"eigen_motion": view.eigen_motion})


@router.get(
    "/animation.svg",
    dependencies=[of_one_clip, heavy],
    response_class=Response,
    responses={200: SVG_ANSWER, 304: UNCHANGED, **refusals(404, ClipNotReady, NotEnoughKeyposes)},
)
def get_animation(lib: Lib, clip_id: ClipId, query: Annotated[AnimationQuery, Query()]) -> Response:
    """The clip as a moving stick figure. With `dimensions`, it shows the low-dimensional motion.

    Left limbs are orange, right limbs are blue. Marks on the floor are half a meter apart.
    """
    picture = animation_svg(lib, clip_id, query.reduction_if_any(), query.start, query.end)
    return Response(picture, media_type="image/svg+xml")
