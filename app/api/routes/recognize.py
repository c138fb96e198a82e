"""Recognition of persons, tasks and words."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Request

from app.api.bodies import is_multipart, read_form, read_json
from app.api.deps import Lib, reads
from app.api.guard.admission import heavy
from app.api.openapi import body, refusals
from app.api.queries import QUERY_FILES, source_of
from app.api.schemas.recognition import Recognition, Recognize, RecognizeForm
from app.errors import ClipNotReady, ModelNotFitted, NotEnoughLabels
from app.services.recognition.recognize import RecognizeQuery
from app.services.recognition.recognize import recognize as recognize_motion

router = APIRouter(prefix="/v1/recognize", tags=["recognition"])

_EXAMPLES = {
    "a stored clip": {"clip_id": "CLIP_ID"},
    "who, when the task is known": {"clip_id": "CLIP_ID", "known_task": "walk"},
}


async def _query(request: Request) -> RecognizeQuery:
    if not is_multipart(request):
        sent = await read_json(request, Recognize)
        return sent.query(sent.source())
    form, uploads = await read_form(request, RecognizeForm, QUERY_FILES)
    return form.query(source_of(form, uploads))


@router.post(
    "",
    dependencies=[reads, Depends(_query), heavy],  # takes a slot after the form has arrived
    responses=refusals(400, 404, 413, 415, 503, 507, ClipNotReady, ModelNotFitted, NotEnoughLabels),
    openapi_extra=body(model=Recognize, examples=_EXAMPLES, form=RecognizeForm, files=QUERY_FILES),
)
def recognize(lib: Lib, query: Annotated[RecognizeQuery, Depends(_query)]) -> Recognition:
    """Recognize person, task and words of a motion. `label` is null if it is unknown."""
    return Recognition.of(recognize_motion(lib, query))
