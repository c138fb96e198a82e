"""The times of analyses are summed by stage."""

from __future__ import annotations

from app.store import stage_times
from app.store.stage_times import StageTime
from app.store.store import Store


def test_times_of_analyses_are_summed(store: Store) -> None:
    with store.read() as tx:
        assert stage_times.totals(tx) == ()
    for seconds in ({"read": 0.5, "symbol": 2.0}, {"read": 0.25}, {}):
        with store.write() as tx:
            stage_times.add(tx, seconds)
    with store.read() as tx:
        found = stage_times.totals(tx)
    assert found == (StageTime("read", 0.75, 2), StageTime("symbol", 2.0, 1))
