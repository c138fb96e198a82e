"""Numbers of rows: exact up to the limit, then close to the truth."""

from __future__ import annotations

import pytest
from sqlalchemy import insert, select

from app.store.database.ids import new_id, share_before, utc_now
from app.store.database.service_tables import api_keys
from app.store.database.totals import total_of
from app.store.store import Store

IDS = select(api_keys.c.id)
ROWS = 4000


@pytest.fixture
def filled(store: Store) -> Store:
    """A store with many rows that have random ids."""
    row = {"name": "", "role": "read", "secret_sha256": "", "created_at": utc_now()}
    rows = [{**row, "id": new_id("row"), "name": str(n % 4)} for n in range(ROWS)]
    with store.write() as tx:
        tx.execute(insert(api_keys), rows)
    return store


@pytest.mark.parametrize("max_exact", [ROWS, ROWS + 1])
def test_a_total_up_to_the_limit_is_exact(filled: Store, max_exact: int) -> None:
    with filled.read() as tx:
        found = total_of(tx, IDS, max_exact, smallest=100)
    assert (found.count, found.is_exact) == (ROWS, True)


@pytest.mark.parametrize(
    ("query", "rows"), [(IDS, 4000), (IDS.where(api_keys.c.name == "1"), 1000)]
)
def test_a_larger_total_is_estimated(filled: Store, query: object, rows: int) -> None:
    with filled.read() as tx:
        found = total_of(tx, query, max_exact=500, smallest=400)  # type: ignore[arg-type]
    assert not found.is_exact
    # Five standard deviations, each of 5 %: less than one run in a million fails.
    assert found.count == pytest.approx(rows, rel=0.25)


def test_an_estimate_is_more_than_what_was_counted(store: Store) -> None:
    row = {"name": "", "role": "read", "secret_sha256": "", "created_at": utc_now()}
    with store.write() as tx:
        tx.execute(insert(api_keys), [{**row, "id": f"row_f{n:019x}"} for n in range(30)])
        assert total_of(tx, IDS, max_exact=20, smallest=10).count == 21


def test_no_rows_and_a_condition_that_all_rows_pass(store: Store) -> None:
    with store.read() as tx:
        assert total_of(tx, IDS).count == 0
        assert total_of(tx, IDS.where(api_keys.c.id != "")).count == 0


def test_the_share_of_ids_before_an_id() -> None:
    assert share_before("row_" + "f" * 20) == 1.0
    assert share_before("row_8" + "0" * 19) == pytest.approx(0.5)
    assert share_before("row_" + "0" * 20) > 0
    with pytest.raises(ValueError):
        share_before("row_x")
