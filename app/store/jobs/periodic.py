"""Tasks that are due from time to time, and that one worker at a time does for all.

A worker takes the turn of a task by writing when it began. Until the task is due again, no other
worker gets a turn, also not if this one dies: such a task only tidies up.
"""

from __future__ import annotations

from datetime import datetime, timedelta
from enum import StrEnum

from sqlalchemy import insert, or_, select, update

from app.store.database.engine import Tx
from app.store.database.ids import utc_now
from app.store.database.service_tables import periodic_tasks


class PeriodicTask(StrEnum):
    """The tasks."""

    SWEEP = "sweep"
    """Tidy the folder of files."""


def take_turn(
    tx: Tx, task: PeriodicTask, interval: timedelta, *, now: datetime | None = None
) -> bool:
    """Whether the task is due, and is the caller's to do; then its next turn is an interval later.

    interval: between two beginnings. Call it in a write transaction.
    """
    now = now or utc_now()
    if not is_due(tx, task, interval, now=now):
        return False
    is_task = periodic_tasks.c.name == task.value
    if not tx.execute(update(periodic_tasks).where(is_task).values(began_at=now)).rowcount:
        tx.execute(insert(periodic_tasks).values(name=task.value, began_at=now))
    return True


def is_due(tx: Tx, task: PeriodicTask, interval: timedelta, *, now: datetime | None = None) -> bool:
    """Whether `take_turn` would take the turn. It only reads.

    A task is due that never began, or began long ago, or in the future: the clock was set back.
    """
    now = now or utc_now()
    waits = select(periodic_tasks.c.name).where(
        periodic_tasks.c.name == task.value,
        ~or_(periodic_tasks.c.began_at <= now - interval, periodic_tasks.c.began_at > now),
    )
    return tx.execute(waits).first() is None
