"""The fitted models of a library: the active ones, their settings. `refit` decides on a new fit."""

from __future__ import annotations

from dataclasses import dataclass

from app.services import fields
from app.services.library.fitted_models import FALSE_ACCEPT_RATE, KINDS_WITH_UNKNOWN
from app.services.library.library import Library
from app.store import models as stored
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobRecord, JobState, NewJob
from app.store.models import ModelRecord

FIT_PRIORITY = 30
"""A fit runs after all ingest jobs."""
FIT_KEY = "fit"


@dataclass(frozen=True, slots=True)
class Unfitted:
    """A kind of model that the last fit did not replace; outcome: "skipped" or "failed"."""

    kind: str
    outcome: str
    reason: str


def list_models(lib: Library) -> tuple[ModelRecord, ...]:
    """The active model of each kind; `meta["figures"]` holds its held-out figures."""
    with lib.store.read() as tx:
        return stored.list_current(tx)


def list_unfitted(lib: Library) -> tuple[Unfitted, ...]:
    """The models that the last fit could not fit, with the reasons; empty before a first fit."""
    with lib.store.read() as tx:
        last = jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items
    outcomes = (last[0].result or {}).get("models", {}) if last else {}
    return tuple(
        Unfitted(kind, outcome["outcome"], outcome["reason"])
        for kind, outcome in outcomes.items()
        if "reason" in outcome
    )


def set_false_accept_rate(lib: Library, model_id: str, rate: float | None) -> ModelRecord:
    """Set how often a recognizer may call something new known.

    rate: in (0, 1); None: the fitted threshold, which weighs both errors equally. It takes
    effect with the next query in all processes, and also applies to later fits. Raises
    NotFound, and BadField for another kind of model or a wrong rate.
    """
    if rate is not None and not 0 < rate < 1:
        raise fields.bad_field(FALSE_ACCEPT_RATE, "must be above 0 and below 1, or null")
    with lib.store.write() as tx:
        record = stored.get(tx, model_id)
        if record.kind not in KINDS_WITH_UNKNOWN:
            raise fields.bad_field(FALSE_ACCEPT_RATE, f"cannot be set for {record.kind} models")
        settings = {} if rate is None else {FALSE_ACCEPT_RATE: rate}
        return stored.set_settings(tx, model_id, settings)


def request_fit(lib: Library) -> JobRecord:
    """Queue a fit of all models; returns the queued job if there is one already."""
    with lib.store.write() as tx:
        return enqueue_fit(tx)


def enqueue_fit(tx: Tx) -> JobRecord:
    """Queue a fit in the caller's transaction."""
    return jobs.enqueue(tx, NewJob(JobKind.FIT, priority=FIT_PRIORITY, dedupe_key=FIT_KEY))
