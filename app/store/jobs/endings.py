"""The end of a job as an event for webhooks, stored in the transaction that ends the job."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product

from sqlalchemy import RowMapping

from app.store.database.engine import Tx
from app.store.jobs.record import OPEN_STATES, JobKind, JobState
from app.store.webhooks import deliveries
from app.store.webhooks.deliveries import Event

EVENTS = tuple(
    f"{kind.value}.{state.value}"
    for kind, state in product(JobKind, JobState)
    if state not in OPEN_STATES
)
"""The names of all events: kind and last state of a job."""


def announce(tx: Tx, jobs: Iterable[RowMapping]) -> None:
    """Store the events that these jobs have ended. jobs: their rows after the end."""
    deliveries.publish(tx, map(_event, jobs))


def _event(job: RowMapping) -> Event:
    # Without the result, which may be large: a receiver asks for the job.
    data = {name: job[name] for name in ("id", "kind", "state", "clip_id", "error")}
    times = {name: job[name] for name in ("created_at", "started_at", "finished_at")}
    told = {name: None if time is None else time.isoformat() for name, time in times.items()}
    return Event(f"{job['kind']}.{job['state']}", {**data, **told})
