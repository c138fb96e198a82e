"""The errors for models that are missing: the reason, and what the client can do."""

from __future__ import annotations

from typing import Any

from app.errors import ModelBeingFitted, ModelNotFitted
from app.store.clips.listing import is_being_analyzed_anew
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import OPEN_STATES, JobKind, JobRecord, JobState

WHAT_TO_DO = "Fit the models: POST /v1/models/fit, or `kinedex fit`."
AFTER_CHANGES = "If this has changed, fit the models again: POST /v1/models/fit, or `kinedex fit`."
UPGRADING = (
    "This version of Kinedex analyzes all clips again, and then fits the models again. Both "
    "happen without a request: try again when they have ended."
)
WHY_REMOVED = (
    "it held a person who was removed from the library, or recognizing people was switched off"
)


def missing_model(tx: Tx, kind: str) -> ModelNotFitted:
    """The error for a kind of model that has no active model.

    It is ModelBeingFitted if a fit is queued or running, or follows when the clips of an earlier
    version have been analyzed again. Otherwise it has the reason that the last fit reported.
    """
    outcome = _last_outcome(tx, kind)
    # A fitted model is removed only to forget persons.
    was_removed = outcome.get("outcome") == "fitted"
    what = (
        f"The {kind} model was removed: {WHY_REMOVED}"
        if was_removed
        else f"No {kind} model has been fitted on this library yet"
    )
    fit = _open_fit(tx)
    if fit is not None:
        doing = "The models are being fitted"
        if was_removed:
            doing = "It is being fitted again without them"
        return ModelBeingFitted(f"{what}. {_try_again(doing, fit)}")
    if "reason" in outcome:
        return ModelNotFitted(f"{what}. At the last fit: {outcome['reason']} {AFTER_CHANGES}")
    if _is_upgrading(tx):
        return ModelBeingFitted(f"{what}. {UPGRADING}")
    return ModelNotFitted(f"{what}. {WHAT_TO_DO}")


def outdated_model(tx: Tx, kind: str) -> ModelNotFitted:
    """The error for a kind of model whose active model this version of Kinedex cannot read."""
    what = f"The {kind} model was fitted by another version of Kinedex"
    fit = _open_fit(tx)
    if fit is not None:
        return ModelBeingFitted(f"{what}. {_try_again('It is being fitted again', fit)}")
    if _is_upgrading(tx):
        return ModelBeingFitted(f"{what}. {UPGRADING}")
    return ModelNotFitted(f"{what}. {WHAT_TO_DO}")


def _is_upgrading(tx: Tx) -> bool:
    """Whether clips of another version wait for a new analysis. The worker fits after that."""
    # Imported here: the analysis is slow to import, and this runs only before an error.
    from app.analysis.analyze import ANALYSIS_VERSION

    return is_being_analyzed_anew(tx, ANALYSIS_VERSION)


def _try_again(doing: str, fit: JobRecord) -> str:
    return f"{doing}: try again when the job {fit.id} has ended."


def _last_outcome(tx: Tx, kind: str) -> dict[str, Any]:
    """The result of the last successful fit for a kind of model; empty if there was no fit."""
    last = jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items
    return dict((last[0].result or {}).get("models", {}).get(kind, {})) if last else {}


def _open_fit(tx: Tx) -> JobRecord | None:
    for state in OPEN_STATES:
        open_fits = jobs.list_jobs(tx, kind=JobKind.FIT, state=state, limit=1).items
        if open_fits:
            return open_fits[0]
    return None
