"""Numbers of clips and open jobs, for the status of a library."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import func, select

from app.store.database.engine import Tx
from app.store.database.tables import clips, jobs
from app.store.jobs.repository import open_states


@dataclass(frozen=True, slots=True)
class OpenJobs:
    """The open jobs of one kind in one state. oldest: when the oldest was created."""

    kind: str
    state: str
    count: int
    oldest: datetime


def count_clips_by_state(tx: Tx) -> dict[str, int]:
    """The number of clips in each state that any clip has."""
    rows = tx.execute(select(clips.c.state, func.count()).group_by(clips.c.state)).all()
    return {state: int(count) for state, count in sorted(rows)}


def count_open_jobs(tx: Tx) -> tuple[OpenJobs, ...]:
    """The open jobs by kind and state, the oldest first."""
    oldest = func.min(jobs.c.created_at)
    query = (
        select(jobs.c.kind, jobs.c.state, func.count(), oldest)
        .where(jobs.c.state.in_(open_states()))
        .group_by(jobs.c.kind, jobs.c.state)
        .order_by(oldest)
    )
    return tuple(OpenJobs(*row) for row in tx.execute(query))
