"""How many rows a list has: exact up to a limit, then estimated, so that a page stays cheap.

Ids are random numbers with a uniform distribution. So the k-th smallest id of a list shows how
many rows the list has: if a share p of all possible ids is not larger than it, there are about
(k - 1) / p rows. With k = 10,000, the standard deviation of this estimate is 1 % (the unbiased
estimator of Beyer et al., *On Synopses for Distinct-Value Estimation Under Multiset Operations*,
2007).

To count 100,000 rows takes 2 ms without a filter and up to 35 ms with one (SQLite).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import Select, func, literal, select

from app.store.database.engine import Tx
from app.store.database.ids import share_before

MAX_EXACT = 100_000
"""Rows that are counted one by one."""
SMALLEST = 10_000
"""k: how many of the smallest ids the estimate looks at."""


@dataclass(frozen=True, slots=True)
class Total:
    """The number of rows of a list; is_exact: false if it is an estimate."""

    count: int
    is_exact: bool = True


def total_of(
    tx: Tx, ids: Select[Any], max_exact: int = MAX_EXACT, smallest: int = SMALLEST
) -> Total:
    """Count the rows of a query that selects one column of ids (`ids.new_id`), without an order.

    smallest: k of the estimate, at most `max_exact`.
    """
    # Without the ids, an index on the filtered column is enough for the database.
    limited = (
        ids.with_only_columns(literal(1), maintain_column_froms=True)
        .limit(max_exact + 1)
        .subquery()
    )
    counted = int(tx.execute(select(func.count()).select_from(limited)).scalar_one())
    if counted <= max_exact:
        return Total(counted)
    column = ids.selected_columns[0]
    last = tx.execute(ids.order_by(column).offset(smallest - 1).limit(1)).scalar_one()
    estimate = round((smallest - 1) / share_before(last))
    return Total(max(estimate, counted), is_exact=False)


def exact_total(tx: Tx, rows: Select[Any]) -> Total:
    """Count all rows of a query, for lists whose ids are not random."""
    return Total(int(tx.execute(select(func.count()).select_from(rows.subquery())).scalar_one()))
