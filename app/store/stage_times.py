"""How long the stages of all analyses took, as sums that every worker adds to.

Each worker has its own process, and the API answers `/metrics`. So the sums are in the database,
where they also survive a restart.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import bindparam, insert, select, update

from app.store.database.engine import Tx
from app.store.database.tables import stage_times

# Built once, because every analysis executes it.
_ADD = (
    update(stage_times)
    .where(stage_times.c.stage == bindparam("the_stage"))
    .values(
        seconds=stage_times.c.seconds + bindparam("more"),
        count=stage_times.c.count + 1,
    )
)


@dataclass(frozen=True, slots=True)
class StageTime:
    """The sum of one stage. seconds: of all analyses; count: the number of analyses."""

    stage: str
    seconds: float
    count: int


def add(tx: Tx, seconds: Mapping[str, float]) -> None:
    """Adds the times of one analysis, in seconds by stage.

    Call it after the transaction has changed the library's version: that locks out a second worker,
    which could add the same new stage.
    """
    known = set(tx.execute(select(stage_times.c.stage)).scalars())
    new = [{"stage": stage, "seconds": 0.0, "count": 0} for stage in seconds if stage not in known]
    if new:
        tx.execute(insert(stage_times), new)
    if seconds:
        rows = [{"the_stage": stage, "more": seconds[stage]} for stage in seconds]
        tx.execute(_ADD, rows)


def totals(tx: Tx) -> tuple[StageTime, ...]:
    """The sums of all stages, by name."""
    rows = tx.execute(select(stage_times).order_by(stage_times.c.stage))
    return tuple(StageTime(*row) for row in rows)
