"""Models that are fitted on the library."""

from __future__ import annotations

from fastapi import APIRouter, Depends

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, quick
from app.api.openapi import ModelId, refusals
from app.api.schemas.jobs import Job, JobStarted
from app.api.schemas.models import Model, ModelList, ModelPatch, UnfittedModel
from app.services.training import models
from app.services.training.active_errors import active_errors

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


@router.post("/fit", status_code=202, dependencies=[writes, changes], responses=refusals(409))
def request_fit(lib: Lib) -> JobStarted:
    """Fit all models again in the background. Until then, searches use the old models."""
    return JobStarted(job=Job.model_validate(models.request_fit(lib)))
