"""Kept results of evaluations. A result never changes: it says how the library was at its time."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import RowMapping, Select, and_, delete, insert, or_, select

from app.errors import EvaluationNotFound
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.tables import evaluations
from app.store.database.totals import Total, total_of

NEWEST_FIRST = "-created_at"
_SHOWN = [column for column in evaluations.c if column.name != "document"]


@dataclass(frozen=True, slots=True)
class NewEvaluation:
    """A result to be kept.

    options: those that were set, by name; library_version, library_size: at the start, the size
    in ready clips; seconds: how long it took; figures: its main figures, in their order, each with
    `name`, `value` and `unit`; document: all results, JSON.
    """

    kind: str
    options: dict[str, Any]
    library_version: int
    library_size: int
    seconds: float
    figures: list[dict[str, Any]]
    document: dict[str, Any]


@dataclass(frozen=True, slots=True)
class EvaluationRecord:
    """A kept result without its document, which may be large: see `document`."""

    id: str
    kind: str
    options: dict[str, Any]
    library_version: int
    library_size: int
    seconds: float
    figures: list[dict[str, Any]]
    created_at: datetime


def add(tx: Tx, new: NewEvaluation) -> EvaluationRecord:
    """Keeps a result."""
    values = asdict(new) | {"id": new_id("eval"), "created_at": utc_now()}
    added = insert(evaluations).values(**values).returning(*_SHOWN)
    return _to_record(tx.execute(added).mappings().one())


def get(tx: Tx, evaluation_id: str) -> EvaluationRecord:
    """The result without its document; raises EvaluationNotFound."""
    query = select(*_SHOWN).where(evaluations.c.id == evaluation_id)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        raise EvaluationNotFound(f"There is no evaluation with the id {evaluation_id!r}")
    return _to_record(row)


def document(tx: Tx, evaluation_id: str) -> dict[str, Any]:
    """All results of an evaluation; raises EvaluationNotFound."""
    query = select(evaluations.c.document).where(evaluations.c.id == evaluation_id)
    found: dict[str, Any] | None = tx.execute(query).scalar_one_or_none()
    if found is None:
        raise EvaluationNotFound(f"There is no evaluation with the id {evaluation_id!r}")
    return found


def before(tx: Tx, record: EvaluationRecord) -> EvaluationRecord | None:
    """The newest earlier result of the same kind; None if there is none."""
    created, row_id = evaluations.c.created_at, evaluations.c.id
    is_earlier = or_(
        created < record.created_at, and_(created == record.created_at, row_id < record.id)
    )
    query = _newest_first(select(*_SHOWN).where(evaluations.c.kind == record.kind, is_earlier))
    row = tx.execute(query.limit(1)).mappings().one_or_none()
    return None if row is None else _to_record(row)


def list_page(
    tx: Tx, *, kind: str | None = None, limit: int = 50, cursor: str | None = None
) -> Page[EvaluationRecord]:
    """One page of at most `limit` results, newest first; raises PageNotFound at "cursor"."""
    query = _of_kind(select(*_SHOWN), kind)
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        is_later = after(evaluations.c.created_at, evaluations.c.id, position, descending=True)
        query = query.where(is_later)
    # One row more than the page shows whether there is another page.
    rows = tx.execute(_newest_first(query).limit(limit + 1)).mappings()
    items = [_to_record(row) for row in rows]
    shown = tuple(items[:limit])
    if len(items) <= limit or not shown:
        return Page(shown, None)
    last = Position(shown[-1].created_at, shown[-1].id)
    return Page(shown, write_cursor(NEWEST_FIRST, last))


def total(tx: Tx, *, kind: str | None = None) -> Total:
    """How many results `list_page` lists; an estimate if there are many."""
    return total_of(tx, _of_kind(select(evaluations.c.id), kind))


def remove(tx: Tx, evaluation_id: str) -> None:
    """Removes a result; raises EvaluationNotFound."""
    if tx.execute(delete(evaluations).where(evaluations.c.id == evaluation_id)).rowcount == 0:
        raise EvaluationNotFound(f"There is no evaluation with the id {evaluation_id!r}")


def remove_where(tx: Tx, holds: Callable[[str], bool]) -> int:
    """Removes the results whose options or document, as JSON text, hold something."""
    query = select(evaluations.c.id, evaluations.c.options, evaluations.c.document)
    found = [
        row_id
        for row_id, options, result in tx.execute(query)
        if holds(json.dumps([options, result], ensure_ascii=False))
    ]
    if found:
        tx.execute(delete(evaluations).where(evaluations.c.id.in_(found)))
    return len(found)


def _of_kind(query: Select[Any], kind: str | None) -> Select[Any]:
    return query if kind is None else query.where(evaluations.c.kind == kind)


def _newest_first(query: Select[Any]) -> Select[Any]:
    return query.order_by(evaluations.c.created_at.desc(), evaluations.c.id.desc())


def _to_record(row: RowMapping) -> EvaluationRecord:
    return EvaluationRecord(
        id=row["id"],
        kind=row["kind"],
        options=dict(row["options"]),
        library_version=row["library_version"],
        library_size=row["library_size"],
        seconds=row["seconds"],
        figures=list(row["figures"]),
        created_at=row["created_at"],
    )
