"""A periodic task is done by one worker at a time."""

from __future__ import annotations

from datetime import timedelta

from app.store.database.ids import utc_now
from app.store.jobs.periodic import PeriodicTask, is_due, take_turn
from app.store.store import Store

HOUR = timedelta(hours=1)


def test_one_worker_gets_each_turn(store: Store) -> None:
    now = utc_now()
    for start in (now, now + HOUR, now + 3 * HOUR):
        with store.read() as tx:
            assert is_due(tx, PeriodicTask.SWEEP, HOUR, now=start)
        turns = []
        for _ in range(3):  # three workers
            with store.write() as tx:
                turns.append(take_turn(tx, PeriodicTask.SWEEP, HOUR, now=start))
        assert turns == [True, False, False]
        with store.read() as tx:
            assert not is_due(tx, PeriodicTask.SWEEP, HOUR, now=start + 0.9 * HOUR)


def test_a_clock_that_was_set_back_stops_no_task(store: Store) -> None:
    now = utc_now()
    with store.write() as tx:
        assert take_turn(tx, PeriodicTask.SWEEP, HOUR, now=now)
        assert take_turn(tx, PeriodicTask.SWEEP, HOUR, now=now - 5 * HOUR)
