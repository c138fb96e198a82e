"""Synthesis: a person's motion for a task that they never recorded."""

from __future__ import annotations

from fastapi import APIRouter, Depends, Request, Response

from app.api.bodies import require_json
from app.api.deps import Lib, writes
from app.api.guard.admission import heavy
from app.api.openapi import refusals
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.synthesis import Synthesis, Synthesize
from app.api.streams import as_octets, wants_octets
from app.services.synthesis.synthesize import SynthesisQuery
from app.services.synthesis.synthesize import synthesize as synthesize_motion

router = APIRouter(prefix="/v1/synthesize", tags=["recognition"])

DESCRIPTION = """\
Make a motion that nobody recorded (Vasilescu 2002, section 4): a known person's for a task that
they never did, of what others did (`person`), or any task by someone of whom there are some
clips (`clip_ids`). It moves the skeleton of one of their files.

`quality` says honestly what to expect: the real clip that the motion is most like, and how often
motions of this kind, made of as little, were taken for the right person and task when the model
was fitted. The more persons did the task, and the more tasks the person did, the better.

With `store` it becomes a clip like any other (201), marked by the source `synthesized`; no model
learns from it. `Accept: application/octet-stream` gives the positions alone.
"""


@router.post(
    "",
    response_model=Synthesis,
    description=DESCRIPTION,
    dependencies=[writes, Depends(require_json), heavy],
    responses={
        200: OCTET_ANSWER,
        201: {"description": "Stored as a clip.", "model": Synthesis},
        **refusals(400, 404, 409, 413, 415, 503, 507),
    },
)
def synthesize(
    lib: Lib, request: Request, response: Response, asked: Synthesize
) -> Response | Synthesis:
    """A motion that nobody recorded."""
    made = synthesize_motion(
        lib,
        SynthesisQuery(
            task=asked.task,
            person=asked.person,
            clip_ids=None if asked.clip_ids is None else tuple(asked.clip_ids),
            seconds=asked.seconds,
            store=asked.store,
        ),
    )
    status = 201 if made.clip is not None and made.is_new else 200
    if wants_octets(request):
        answer = as_octets(made.view)
        answer.status_code = status
        return answer
    response.status_code = status
    return Synthesis.of(made, with_bvh=asked.bvh)
