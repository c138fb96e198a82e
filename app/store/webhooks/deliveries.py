"""Deliveries: events that webhooks still have to receive, stored until they are received.

Each webhook receives its events one after the other, in the order in which they happened. A worker
that takes a delivery postpones the webhook for TAKEN_SECONDS. If the worker dies, the delivery is
due again after that. So an event is delivered at least once; its id is the same each time.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass, field
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import RowMapping, and_, bindparam, delete, exists, insert, or_, select, update

from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.service_tables import webhook_deliveries, webhooks
from app.store.webhooks.repository import drop_pending

TAKEN_SECONDS = 60.0
"""Time in which a worker must have delivered what it took."""
FIRST_DELAY_SECONDS, MAX_DELAY_SECONDS = 5.0, 6 * 3600.0
"""Time before the next try; it doubles with each failure."""
MAX_FAILURES = 16
"""Failures in a row after which a webhook is switched off: after about a day."""


@dataclass(frozen=True, slots=True)
class Event:
    """Something that happened. data: what, as JSON."""

    name: str
    data: dict[str, Any]


@dataclass(frozen=True, slots=True)
class Delivery:
    """One try to deliver an event. id: of the event; body: JSON; attempt: from 1."""

    id: str
    webhook_id: str
    url: str
    secret: str = field(repr=False)
    event: str
    body: str
    attempt: int


@dataclass(frozen=True, slots=True)
class Outcome:
    """The outcome of a try. status: of HTTP, None without an answer; detail: why it failed."""

    is_delivered: bool
    status: int | None
    detail: str | None = None
    is_gone: bool = False
    """Whether the receiver said that it wants no events any more (410)."""


def publish(tx: Tx, events: Iterable[Event]) -> None:
    """Store each event for each webhook that receives it, in the caller's transaction."""
    receivers = tx.execute(_ENABLED).all()
    rows = [
        _row(event, receiver.id)
        for event in (events if receivers else ())
        for receiver in receivers
        if not receiver.events or event.name in receiver.events
    ]
    if rows:
        tx.execute(_ADD, rows)


def add(tx: Tx, webhook_id: str, event: Event) -> None:
    """Store an event for one webhook."""
    tx.execute(_ADD, [_row(event, webhook_id)])


def _row(event: Event, webhook_id: str) -> dict[str, Any]:
    now = utc_now()
    members = {"type": event.name, "timestamp": now.isoformat(), "data": event.data}
    return {
        "id": new_id("msg"),
        "webhook_id": webhook_id,
        "event": event.name,
        "body": json.dumps(members, allow_nan=False),
        "attempts": 0,
        "created_at": now,
    }


def is_any_due(tx: Tx, *, now: datetime | None = None) -> bool:
    """Whether `take_due` would take something. It only reads."""
    return tx.execute(_DUE.limit(1), _times(now)).first() is not None


def take_due(tx: Tx, most: int, *, now: datetime | None = None) -> tuple[Delivery, ...]:
    """Take the oldest event of each webhook that is due, of at most `most` webhooks."""
    times = _times(now)
    found = tx.execute(_DUE.limit(most), times).mappings().all()
    return tuple(_take(tx, row, times["now"]) for row in found)


def settle(tx: Tx, tried: Delivery, outcome: Outcome, *, now: datetime | None = None) -> None:
    """Record the outcome of a try. Does nothing if another worker has taken the delivery since."""
    now = now or utc_now()
    this_try = and_(
        webhook_deliveries.c.id == tried.id, webhook_deliveries.c.attempts == tried.attempt
    )
    if tx.execute(select(webhook_deliveries.c.id).where(this_try)).first() is None:
        return
    last = {
        "id": tried.id,
        "event": tried.event,
        "state": "delivered" if outcome.is_delivered else "failed",
        "attempt": tried.attempt,
        "status": outcome.status,
        "detail": outcome.detail,
        "at": now.isoformat(),
    }
    if outcome.is_delivered:
        tx.execute(delete(webhook_deliveries).where(this_try))
        _set(tx, tried.webhook_id, failures=0, not_before=None, last_delivery=last)
    else:
        _fail(tx, tried, outcome, last, now)


def _fail(tx: Tx, tried: Delivery, outcome: Outcome, last: dict[str, Any], now: datetime) -> None:
    webhook = tx.execute(_ONE, {"webhook": tried.webhook_id}).mappings().one()
    failures = webhook["failures"] + 1
    values: dict[str, Any] = {"failures": failures, "last_delivery": last}
    if outcome.is_gone or failures >= MAX_FAILURES or not webhook["is_enabled"]:
        _set(tx, tried.webhook_id, **values, is_enabled=False, not_before=None)
        drop_pending(tx, tried.webhook_id)
    else:
        delay = min(FIRST_DELAY_SECONDS * 2 ** (failures - 1), MAX_DELAY_SECONDS)
        _set(tx, tried.webhook_id, **values, not_before=now + timedelta(seconds=delay))


def _take(tx: Tx, webhook: RowMapping, now: datetime) -> Delivery:
    row = tx.execute(_OLDEST, {"webhook": webhook["id"]}).mappings().one()
    attempt = row["attempts"] + 1
    taken = update(webhook_deliveries).where(webhook_deliveries.c.id == row["id"])
    tx.execute(taken.values(attempts=attempt))
    _set(tx, webhook["id"], not_before=now + timedelta(seconds=TAKEN_SECONDS))
    return Delivery(
        id=row["id"],
        webhook_id=webhook["id"],
        url=webhook["url"],
        secret=webhook["secret"],
        event=row["event"],
        body=row["body"],
        attempt=attempt,
    )


def _set(tx: Tx, webhook_id: str, **values: Any) -> None:
    tx.execute(update(webhooks).where(webhooks.c.id == webhook_id).values(values))


def _times(now: datetime | None) -> dict[str, datetime]:
    now = now or utc_now()
    return {"now": now, "far": now + timedelta(seconds=MAX_DELAY_SECONDS)}


# Made once: to make a statement takes longer than to run it.
_ENABLED = select(webhooks.c.id, webhooks.c.events).where(webhooks.c.is_enabled)
_ONE = select(webhooks).where(webhooks.c.id == bindparam("webhook"))
_ADD = insert(webhook_deliveries)
_MOMENT = webhooks.c.not_before.type
_DUE = (
    select(webhooks.c.id, webhooks.c.url, webhooks.c.secret)
    .where(
        # A webhook that is off has nothing but a test event.
        or_(
            webhooks.c.not_before.is_(None),
            webhooks.c.not_before <= bindparam("now", type_=_MOMENT),
            # The clock was set back: no delivery is postponed for so long.
            webhooks.c.not_before > bindparam("far", type_=_MOMENT),
        ),
        exists().where(webhook_deliveries.c.webhook_id == webhooks.c.id),
    )
    # Without nulls_first, databases put those that never failed first or last.
    .order_by(webhooks.c.not_before.nulls_first(), webhooks.c.id)
)
_OLDEST = (
    select(webhook_deliveries)
    .where(webhook_deliveries.c.webhook_id == bindparam("webhook"))
    .order_by(webhook_deliveries.c.created_at, webhook_deliveries.c.id)
    .limit(1)
)
