"""Webhooks: adding, reading, changing, removing."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from sqlalchemy import RowMapping, delete, func, insert, select, update

from app.errors import WebhookNotFound
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.service_tables import webhook_deliveries, webhooks


@dataclass(frozen=True, slots=True)
class WebhookRecord:
    """A webhook.

    events: the events that it receives, empty for all; last_delivery: the outcome of the last
    try (`deliveries.settle`), None before the first; pending: events that it still has to receive;
    failures: tries that failed since the last success.
    """

    id: str
    url: str
    secret: str = field(repr=False)
    events: tuple[str, ...]
    is_enabled: bool
    failures: int
    last_delivery: dict[str, Any] | None
    created_at: datetime
    pending: int


def add(
    tx: Tx, url: str, secret: str, events: Collection[str], *, is_enabled: bool = True
) -> WebhookRecord:
    """Add a webhook."""
    webhook_id = new_id("webhook")
    row = {
        "id": webhook_id,
        "url": url,
        "secret": secret,
        "events": list(events),
        "is_enabled": is_enabled,
        "failures": 0,
        "created_at": utc_now(),
    }
    tx.execute(insert(webhooks).values(row))
    return get(tx, webhook_id)


def get(tx: Tx, webhook_id: str) -> WebhookRecord:
    """Return a webhook. Raises WebhookNotFound."""
    row = tx.execute(_LISTED.where(webhooks.c.id == webhook_id)).mappings().one_or_none()
    if row is None:
        raise WebhookNotFound(f"There is no webhook with the id {webhook_id!r}")
    return _to_record(row)


def list_all(tx: Tx) -> tuple[WebhookRecord, ...]:
    """Return all webhooks, the newest first."""
    rows = tx.execute(_LISTED.order_by(webhooks.c.created_at.desc(), webhooks.c.id)).mappings()
    return tuple(_to_record(row) for row in rows)


def change(
    tx: Tx,
    webhook_id: str,
    *,
    events: Collection[str] | None = None,
    is_enabled: bool | None = None,
) -> WebhookRecord:
    """Change the events, or switch a webhook on or off. Raises WebhookNotFound.

    A webhook that is switched on is tried again at once. Events that end while it is off are lost.
    """
    get(tx, webhook_id)
    values: dict[str, Any] = {}
    if events is not None:
        values["events"] = list(events)
    if is_enabled is not None:
        values |= {"is_enabled": is_enabled, "failures": 0, "not_before": None}
    if values:
        tx.execute(update(webhooks).where(webhooks.c.id == webhook_id).values(values))
    if is_enabled is False:
        drop_pending(tx, webhook_id)
    return get(tx, webhook_id)


def remove(tx: Tx, webhook_id: str) -> None:
    """Remove a webhook and the events that it still had to receive. Raises WebhookNotFound."""
    get(tx, webhook_id)
    tx.execute(delete(webhooks).where(webhooks.c.id == webhook_id))


def drop_pending(tx: Tx, webhook_id: str) -> None:
    """Remove the events that a webhook still has to receive."""
    tx.execute(delete(webhook_deliveries).where(webhook_deliveries.c.webhook_id == webhook_id))


_PENDING = (
    select(func.count())
    .where(webhook_deliveries.c.webhook_id == webhooks.c.id)
    .scalar_subquery()
    .label("pending")
)
_LISTED = select(webhooks, _PENDING)


def _to_record(row: RowMapping) -> WebhookRecord:
    return WebhookRecord(
        id=row["id"],
        url=row["url"],
        secret=row["secret"],
        events=tuple(row["events"]),
        is_enabled=row["is_enabled"],
        failures=row["failures"],
        last_delivery=row["last_delivery"],
        created_at=row["created_at"],
        pending=row["pending"],
    )
