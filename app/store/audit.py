"""The audit log: who changed, exported or forgot what, and when.

A change is recorded in the transaction that makes it: the log has a row exactly if the change was
committed. Rows are never changed. They hold ids, names of fields and counts, but no label, no text
and no file name, so that a forgotten person's name is not in them. Rows that are older than the
setting `audit_retention_days` are removed.

action: the operation of the API, as its description names it (`update_clip`, `forget_person`,
`get_export`), or the command (`kinedex keys create`). What workers do later belongs to the call
that queued its job: the row of that call has the id of the job.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, RowMapping, delete, insert, select

from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.service_tables import api_keys, audit_log
from app.store.database.totals import Total, total_of

NEWEST_FIRST = "-at"


@dataclass(slots=True)
class Call:
    """A call or command that changes or exports something.

    key_id: of the API key, None without one; address: of the client, None for a command on this
    machine; clip_id: the clip that it is about; details: ids, names of fields and counts;
    is_recorded: whether the log has its row.
    """

    action: str
    key_id: str | None = None
    address: str | None = None
    clip_id: str | None = None
    details: dict[str, Any] = field(default_factory=dict)
    is_recorded: bool = False


@dataclass(frozen=True, slots=True)
class AuditRecord:
    """A row of the log. key_name: the present name of the key."""

    id: str
    at: datetime
    action: str
    key_id: str | None
    key_name: str | None
    address: str | None
    clip_id: str | None
    details: dict[str, Any]


@dataclass(frozen=True, slots=True)
class AuditFilter:
    """Conditions on rows: not before `since`, before `until`, of a key, an action, a clip."""

    since: datetime | None = None
    until: datetime | None = None
    key_id: str | None = None
    action: str | None = None
    clip_id: str | None = None


@contextmanager
def calling(call: Call) -> Iterator[None]:
    """The write transactions of the block belong to this call; the first of them records it."""
    token = _current.set(call)
    try:
        yield
    finally:
        _current.reset(token)


def note(*, clip_id: str | None = None, **details: Any) -> None:
    """Say more about the call that runs, if one runs: the first clip, the first job, counts."""
    call = _current.get()
    if call is None:
        return
    call.clip_id = call.clip_id or clip_id
    for name, value in details.items():
        call.details.setdefault(name, value)


def record(tx: Tx) -> None:
    """Record the call that runs, unless it is recorded. Each write transaction ends with it."""
    call = _current.get()
    if call is not None and not call.is_recorded:
        add(tx, call)


def settle() -> None:
    """The transaction was committed: the row of the call that runs is there for good."""
    call = _current.get()
    if call is not None:
        call.is_recorded = True


def add(tx: Tx, call: Call) -> None:
    """Add the row of a call."""
    row = {
        "id": new_id("audit"),
        "at": utc_now(),
        "action": call.action,
        "key_id": call.key_id,
        "address": call.address,
        "clip_id": call.clip_id,
        "details": call.details,
    }
    tx.execute(_ADD, row)


def list_page(
    tx: Tx, filter: AuditFilter, *, limit: int = 50, cursor: str | None = None
) -> Page[AuditRecord]:
    """One page of at most `limit` rows, newest first; raises BadField at "cursor"."""
    query = select(audit_log, api_keys.c.name.label("key_name")).outerjoin(
        api_keys, api_keys.c.id == audit_log.c.key_id
    )
    query = query.where(*_conditions(filter))
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        query = query.where(after(audit_log.c.at, audit_log.c.id, position, descending=True))
    newest = query.order_by(audit_log.c.at.desc(), audit_log.c.id.desc())
    # One row more than the page shows whether there is another page.
    rows = [_to_record(row) for row in tx.execute(newest.limit(limit + 1)).mappings()]
    shown = tuple(rows[:limit])
    if len(rows) <= limit:
        return Page(shown, None)
    return Page(shown, write_cursor(NEWEST_FIRST, Position(shown[-1].at, shown[-1].id)))


def total(tx: Tx, filter: AuditFilter) -> Total:
    """How many rows `list_page` lists; an estimate if there are many."""
    return total_of(tx, select(audit_log.c.id).where(*_conditions(filter)))


def is_any_before(tx: Tx, end: datetime) -> bool:
    """Whether there are rows older than `end`."""
    return (
        tx.execute(select(audit_log.c.id).where(audit_log.c.at < end).limit(1)).first() is not None
    )


def remove_before(tx: Tx, end: datetime, limit: int) -> int:
    """Remove at most `limit` rows that are older than `end`; returns how many."""
    oldest = select(audit_log.c.id).where(audit_log.c.at < end).order_by(audit_log.c.at)
    return tx.execute(delete(audit_log).where(audit_log.c.id.in_(oldest.limit(limit)))).rowcount


_current: ContextVar[Call | None] = ContextVar("audited_call", default=None)
_ADD = insert(audit_log)


def _conditions(filter: AuditFilter) -> Iterator[ColumnElement[bool]]:
    if filter.since is not None:
        yield audit_log.c.at >= filter.since
    if filter.until is not None:
        yield audit_log.c.at < filter.until
    for name in ("key_id", "action", "clip_id"):
        value = getattr(filter, name)
        if value is not None:
            yield audit_log.c[name] == value


def _to_record(row: RowMapping) -> AuditRecord:
    return AuditRecord(
        id=row["id"],
        at=row["at"],
        action=row["action"],
        key_id=row["key_id"],
        key_name=row["key_name"],
        address=row["address"],
        clip_id=row["clip_id"],
        details=dict(row["details"]),
    )
