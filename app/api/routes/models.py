"""Models that are fitted on the library."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.openapi import ModelId, refusals
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
    Signatures,
    UnfittedModel,
)
from app.errors import ModelNotFitted
from app.services.recognition import confusion
from app.services.recognition.signatures import signature_points
from app.services.training import models
from app.services.training.active_errors import active_errors

TaskOrPerson = Annotated[
    str, Query(min_length=1, max_length=300, openapi_examples={"a task": {"value": "TASK"}})
]

router = APIRouter(prefix="/v1/models", tags=["models"])


@router.get("", dependencies=[reads, quick], responses=refusals())
def list_models(lib: Lib) -> ModelList:
    """The current model of each kind, with the library's size at the fit and held-out figures."""
    return ModelList(
        items=[Model.of(one, active_errors(lib, one)) for one in models.list_models(lib)],
        unfitted=[UnfittedModel.model_validate(one) for one in models.list_unfitted(lib)],
    )


@router.patch(
    "/{model_id}",
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


@router.get("/signatures", dependencies=[reads, heavy], responses=refusals(ModelNotFitted))
def list_signatures(lib: Lib) -> Signatures:
    """The signature of each person in the multilinear model, as a point in two dimensions."""
    return Signatures.of(*signature_points(lib))


@router.post("/fit", status_code=202, dependencies=[writes, changes], responses=refusals())
def request_fit(lib: Lib) -> JobStarted:
    """Fit all models again in the background. Until the fit ends, searches use the old models."""
    return JobStarted(job=Job.model_validate(models.request_fit(lib)))
