"""Models that are fitted on the library."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Path, Query, Request, Response

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.openapi import ModelId, SignatureModelId, refusals
from app.api.path_parameters import register_other_than
from app.api.routes.clip_views import OCTET_ANSWER
from app.api.schemas.base import Limit
from app.api.schemas.clips import Clip
from app.api.schemas.jobs import Job, JobStarted
from app.api.schemas.models import (
    ConfusedClips,
    Confusion,
    ConfusionQuery,
    Factor,
    Model,
    ModelList,
    ModelPatch,
    UnfittedModel,
)
from app.api.schemas.signatures import EigenmotionQuery, Signatures, SignaturesQuery
from app.api.schemas.views import Motion
from app.api.streams import as_json, as_octets, prefers_octets
from app.errors import ModelNotFitted, NoSignatures
from app.services.recognition import confusion, signatures
from app.services.recognition.signatures import MAX_EIGENMOTIONS
from app.services.training import models
from app.services.training.active_errors import active_errors

TaskOrPerson = Annotated[
    str, Query(min_length=1, max_length=300, openapi_examples={"a task": {"value": "TASK"}})
]
EigenmotionNumber = Annotated[
    int, Path(ge=1, le=MAX_EIGENMOTIONS, openapi_examples={"the first": {"value": 1}})
]

MODEL = register_other_than("model", "confusion", "fit")
router = APIRouter(prefix="/v1/models", tags=["models"])


@router.get("", dependencies=[reads, quick], responses=refusals())
def list_models(lib: Lib) -> ModelList:
    """The current model of each kind, with the library's size at the fit and held-out figures."""
    return ModelList(
        items=[Model.of(one, active_errors(lib, one)) for one in models.list_models(lib)],
        unfitted=[UnfittedModel.model_validate(one) for one in models.list_unfitted(lib)],
    )


@router.patch(
    f"/{{model_id:{MODEL}}}",
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def update_model(lib: Lib, model_id: ModelId, patch: ModelPatch) -> Model:
    """Set the false-accept rate of a recognizer. It applies at once, and also after later fits."""
    record = models.set_false_accept_rate(lib, model_id, patch.false_accept_rate)
    return Model.of(record, active_errors(lib, record))


@router.get("/confusion", dependencies=[reads, heavy], responses=refusals(ModelNotFitted))
def get_confusion(lib: Lib, query: Annotated[ConfusionQuery, Query()]) -> Confusion:
    """What the recognizer takes clips for that it has not seen, as a confusion matrix."""
    return Confusion.of(query.factor, *confusion.confusion(lib, query.factor))


@router.get("/confusion/clips", dependencies=[reads, heavy], responses=refusals(ModelNotFitted))
def list_confused_clips(
    lib: Lib, label: TaskOrPerson, guess: TaskOrPerson, factor: Factor = "task", limit: Limit = 100
) -> ConfusedClips:
    """The clips with a label that were taken for `guess`: a cell of the confusion matrix."""
    found = confusion.confused_clips(lib, factor, label, guess, limit)
    return ConfusedClips(items=[Clip.model_validate(clip) for clip in found])


@router.get(
    "/{model_id}/signatures",
    dependencies=[reads, heavy],
    responses=refusals(404, NoSignatures, ModelNotFitted),
)
def get_signatures(
    lib: Lib, model_id: SignatureModelId, query: Annotated[SignaturesQuery, Query()]
) -> Signatures:
    """Persons, tasks and eigenmotions of a multilinear model as vectors, and weights of clips.

    Models of the kinds `signatures` (joint angles, as in Vasilescu 2002) and `multilinear`
    (positions) have them.
    """
    found = signatures.signatures(lib, model_id, query.as_filter(), query.limit, query.cursor)
    return Signatures.of(found, query.eigenmotions)


@router.get(
    "/{model_id}/eigenmotions/{number}/motion",
    response_model=Motion,
    dependencies=[reads, heavy],
    responses={200: OCTET_ANSWER, **refusals(404, NoSignatures, ModelNotFitted)},
)
def get_eigenmotion(
    lib: Lib,
    request: Request,
    model_id: SignatureModelId,
    number: EigenmotionNumber,
    query: Annotated[EigenmotionQuery, Query()],
) -> Response:
    """The mean motion, moved along an eigenmotion, as the motion of a clip: to play it.

    It has the 13 joints of figure 2 in Sun 2011. The body faces Z and stays in place, and its lower
    foot is on the floor.
    """
    view = signatures.eigenmotion(lib, model_id, number, query.deviations, query.seconds)
    return as_octets(view) if prefers_octets(request) else as_json(view)


@router.post("/fit", status_code=202, dependencies=[writes, changes], responses=refusals())
def request_fit(lib: Lib) -> JobStarted:
    """Fit all models again in the background. Until the fit ends, searches use the old models."""
    return JobStarted(job=Job.model_validate(models.request_fit(lib)))
