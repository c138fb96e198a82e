"""The fitted models of a library: what is in force, and when to fit again."""

from __future__ import annotations

from dataclasses import dataclass

from app.services import fields
from app.services.library.fitted_models import FALSE_ACCEPT_RATE, TELLING_UNKNOWN
from app.services.library.library import Library
from app.store import models as stored
from app.store.clips import versions as library
from app.store.clips.filter import ClipFilter
from app.store.clips.listing import count_clips
from app.store.clips.record import ClipState
from app.store.database.engine import Tx
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobRecord, JobState, NewJob
from app.store.models import ModelRecord

FIT_PRIORITY = 30
"""After every ingest."""
MIN_CLIPS = 2
"""Ready clips below which nothing is fitted unasked: a model of one clip tells nothing."""
FIT_KEY = "fit"
_READY = ClipFilter(state=(ClipState.READY,))


@dataclass(frozen=True, slots=True)
class Unfitted:
    """A kind of model that the last fit left as it was; outcome: "skipped" or "failed"."""

    kind: str
    outcome: str
    reason: str


def list_models(lib: Library) -> tuple[ModelRecord, ...]:
    """The model in force of each kind; `meta["figures"]` holds its held-out figures."""
    with lib.store.read() as tx:
        return stored.list_current(tx)


def list_unfitted(lib: Library) -> tuple[Unfitted, ...]:
    """What the last fit could not fit, with the reason; nothing before the first fit."""
    with lib.store.read() as tx:
        last = jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items
    outcomes = (last[0].result or {}).get("models", {}) if last else {}
    return tuple(
        Unfitted(kind, outcome["outcome"], outcome["reason"])
        for kind, outcome in outcomes.items()
        if "reason" in outcome
    )


def set_false_accept_rate(lib: Library, model_id: str, rate: float | None) -> ModelRecord:
    """How often a recognizer may call something new known; None: where both errors weigh alike.

    Takes effect with the next question, on every replica, and stays when the model is fitted
    anew. Raises NotFound, BadField for another kind of model or a rate outside 0..1.
    """
    if rate is not None and not 0 < rate < 1:
        raise fields.bad_field(FALSE_ACCEPT_RATE, "must be above 0 and below 1, or null")
    with lib.store.write() as tx:
        record = stored.get(tx, model_id)
        if record.kind not in TELLING_UNKNOWN:
            raise fields.bad_field(FALSE_ACCEPT_RATE, f"cannot be set for {record.kind} models")
        settings = {} if rate is None else {FALSE_ACCEPT_RATE: rate}
        return stored.set_settings(tx, model_id, settings)


def request_fit(lib: Library) -> JobRecord:
    """Queue a fit of all models; one that is queued already is enough."""
    with lib.store.write() as tx:
        return enqueue_fit(tx)


def enqueue_fit(tx: Tx) -> JobRecord:
    """Queue a fit in the caller's transaction."""
    return jobs.enqueue(tx, NewJob(JobKind.FIT, priority=FIT_PRIORITY, dedupe_key=FIT_KEY))


def is_fit_due(tx: Tx, growth: float) -> bool:
    """Whether the library has changed by the part `growth` since its last fit.

    Counts clips that were added, analyzed again or labeled anew, and those that are gone.
    Never due while a fit or an ingest is still to end, or below MIN_CLIPS ready clips.
    """
    ready = count_clips(tx, _READY)
    if ready < MIN_CLIPS or _is_open(tx, JobKind.FIT) or _is_open(tx, JobKind.INGEST):
        return False
    last = _last_fit(tx)
    if last is None:
        return True
    version, size = last
    changes = library.changed_since(tx, version)
    return len(changes.changed) + len(changes.removed) >= max(growth * size, 1)


def _last_fit(tx: Tx) -> tuple[int, int] | None:
    """Library version and size that the last fit saw, whether or not it could fit anything."""
    found = [(r.library_version, r.library_size) for r in stored.list_current(tx)]
    for job in jobs.list_jobs(tx, kind=JobKind.FIT, state=JobState.SUCCEEDED, limit=1).items:
        result = job.result or {}
        found.append((int(result["library_version"]), int(result["library_size"])))
    return max(found, default=None)


def _is_open(tx: Tx, kind: JobKind) -> bool:
    return any(
        jobs.list_jobs(tx, kind=kind, state=state, limit=1).items
        for state in (JobState.QUEUED, JobState.PROCESSING)
    )
