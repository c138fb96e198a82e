"""Synthesis: the motion of a person for a task that was never recorded of this person."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import require_json
from app.api.deps import Lib, writes
from app.api.guard.admission import heavy
from app.api.openapi import refusals
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.synthesis import Synthesis, Synthesize
from app.api.streams import as_octets, prefers_octets
from app.errors import ClipNotReady, ModelNotFitted, NotEnoughLabels
from app.services.synthesis.synthesize import SynthesisQuery
from app.services.synthesis.synthesize import synthesize as synthesize_motion

router = APIRouter(prefix="/v1/synthesize", tags=["recognition"])

DESCRIPTION = """\
Make a motion that nobody recorded (Vasilescu 2002, section 4). With `person`, it is the motion of
a person of the library for a task that only others did. With `clip_ids`, it is the motion of
somebody of whom there are some clips. The motion uses the skeleton of one of the person's files.

`quality` says what to expect. It names the real clip that is most similar to the motion. It also
says how often such motions, made from equally little data, were recognized as the right person and
task when the model was fitted. The quality is better if more persons did the task, and if the
person did more tasks.

With `store`, the motion becomes a clip (201) with the source `synthesized`. No model learns from
it. `Accept: application/octet-stream` returns only the positions.
"""


@router.post(
    "",
    response_model=Synthesis,
    description=DESCRIPTION,
    dependencies=[writes, Depends(require_json), heavy],
    responses={
        200: OCTET_ANSWER,
        201: {"description": "Stored as a clip.", "model": Synthesis},
        **refusals(400, 404, 413, 415, 503, 507, ClipNotReady, ModelNotFitted, NotEnoughLabels),
    },
)
def synthesize(
    lib: Lib, request: Request, response: Response, sent: Synthesize
) -> Response | Synthesis:
    """A motion that nobody recorded."""
    made = synthesize_motion(
        lib,
        SynthesisQuery(
            task=sent.task,
            person=sent.person,
            clip_ids=None if sent.clip_ids is None else tuple(sent.clip_ids),
            seconds=sent.seconds,
            store=sent.store,
        ),
    )
    status = 201 if made.clip is not None and made.is_new else 200
    if prefers_octets(request):
        answer = as_octets(made.view)
        answer.status_code = status
        return answer
    response.status_code = status
    return Synthesis.of(made, with_bvh=sent.bvh)
