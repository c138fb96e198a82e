"""Evaluations: start one, list the kept results, read one with all its figures, delete it."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Depends, Query

from app.api.bodies import require_json
from app.api.deps import Lib, reads, writes
from app.api.guard.admission import changes, heavy, quick
from app.api.openapi import EvaluationId, refusals
from app.api.schemas.evaluations import (
    Evaluation,
    EvaluationList,
    EvaluationQuery,
    NewEvaluation,
)
from app.api.schemas.jobs import Job, JobStarted
from app.services.evaluations import evaluations

router = APIRouter(prefix="/v1/evaluations", tags=["models"])


@router.post(
    "",
    status_code=202,
    dependencies=[writes, Depends(require_json), changes],
    responses=refusals(400, 413, 415),
)
def start_evaluation(lib: Lib, new: NewEvaluation) -> JobStarted:
    """Measure how well the methods do on the labels of this library, in the background.

    Words and recognition are held out: no clip is judged by a model that has seen its recording.
    150 clips take from a second to a minute, by the kind; more clips take longer. Follow the job;
    when it has succeeded, its result has the `evaluation_id`. Cancel it with
    `DELETE /v1/jobs/{id}`. If the library has too few labels, the job fails with the reason.
    """
    job = evaluations.request(lib, new.kind, new.options())
    return JobStarted(job=Job.model_validate(job))


@router.get("", dependencies=[reads, quick], responses=refusals(404))
def list_evaluations(lib: Lib, query: Annotated[EvaluationQuery, Query()]) -> EvaluationList:
    """The kept evaluations with their main figures, the newest first."""
    page = evaluations.list_evaluations(lib, query.kind, query.limit, query.cursor)
    return EvaluationList.model_validate(page)


@router.get("/{evaluation_id}", dependencies=[reads, heavy], responses=refusals(404))
def get_evaluation(lib: Lib, evaluation_id: EvaluationId) -> Evaluation:
    """One evaluation with all its results, and the one before it to compare with."""
    return Evaluation.of(*evaluations.get_evaluation(lib, evaluation_id))


@router.delete(
    "/{evaluation_id}",
    status_code=204,
    dependencies=[writes, changes],
    responses=refusals(404),
)
def delete_evaluation(lib: Lib, evaluation_id: EvaluationId) -> None:
    """Delete a kept evaluation."""
    evaluations.delete_evaluation(lib, evaluation_id)
