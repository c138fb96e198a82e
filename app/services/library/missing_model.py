"""Why a model is not there, and what to do about it."""

from __future__ import annotations

from typing import Any

from app.errors import ModelBeingFitted, ModelNotFitted
from app.store.clips.listing import is_being_analyzed_anew
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import OPEN_STATES, JobKind, JobRecord, JobState

WHAT_TO_DO = "Fit the models: POST /v1/models/fit, or `kinedex fit`."
UPGRADING = (
    "The models are being fitted anew by themselves, once the clips are analysed anew, as this "
    "version of Kinedex needs them: ask again when that has ended."
)
WHY_REMOVED = (
    "a person whom it held was removed from the library, or recognizing people was switched off"
)


def missing_model(tx: Tx, kind: str) -> ModelNotFitted:
    """What to raise for a kind of which no model is in force.

    ModelBeingFitted where a fit waits or runs, or will once clips of an earlier analysis are
    analysed anew; else with the reason that the last fit gave.
    """
    outcome = _last_outcome(tx, kind)
    # What the last fit made is taken away for this reason only.
    gone = outcome.get("outcome") == "fitted"
    what = (
        f"The {kind} model was removed: {WHY_REMOVED}"
        if gone
        else f"No {kind} model has been fitted on this library yet"
    )
    fit = _open_fit(tx)
    if fit is not None:
        anew = "It is being fitted anew without them" if gone else "The models are being fitted"
        return ModelBeingFitted(f"{what}. {_ask_again(anew, fit)}")
    if "reason" in outcome:
        return ModelNotFitted(f"{what}. {outcome['reason']}")
    if _is_upgrading(tx):
        return ModelBeingFitted(f"{what}. {UPGRADING}")
    return ModelNotFitted(f"{what}. {WHAT_TO_DO}")


def outdated_model(tx: Tx, kind: str) -> ModelNotFitted:
    """What to raise for a kind whose model in force this version of Kinedex cannot read."""
    what = f"The {kind} model was fitted by another version of Kinedex"
    fit = _open_fit(tx)
    if fit is not None:
        return ModelBeingFitted(f"{what}. {_ask_again('It is being fitted anew', fit)}")
    if _is_upgrading(tx):
        return ModelBeingFitted(f"{what}. {UPGRADING}")
    return ModelNotFitted(f"{what}. {WHAT_TO_DO}")


def _is_upgrading(tx: Tx) -> bool:
    """Whether a worker analyses anew what another version described; it fits after that."""
    from app.analysis.analyze import ANALYSIS_VERSION

    return is_being_analyzed_anew(tx, ANALYSIS_VERSION)


def _ask_again(doing: str, fit: JobRecord) -> str:
    return f"{doing}: ask again when the job {fit.id} has ended."


def _last_outcome(tx: Tx, kind: str) -> dict[str, Any]:
    """What the last fit that ended made of a kind; empty where there was none."""
    last = jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items
    return dict((last[0].result or {}).get("models", {}).get(kind, {})) if last else {}


def _open_fit(tx: Tx) -> JobRecord | None:
    for state in OPEN_STATES:
        found = jobs.list_jobs(tx, kind=JobKind.FIT, state=state, limit=1).items
        if found:
            return found[0]
    return None
