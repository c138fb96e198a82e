"""Answers: audit. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from kinedex.records import Page, Record


@dataclass(frozen=True, slots=True)
class AuditEntry(Record):
    """A change or an export, by whom and when.

    action: The operation of this API, as `update_clip`, `forget_person` or `get_export`; or the
    command, as `kinedex keys create`.
    key_id: The API key; null without one.
    key_name: The name of the key.
    address: The client's address; null for a command on the machine of the library.
    clip_id: The clip that it is about.
    details: Ids, names of changed fields and counts. No labels: a forgotten person's name is
    not in the log.
    """

    id: str
    at: datetime
    action: str
    key_id: str | None
    key_name: str | None
    address: str | None
    clip_id: str | None
    details: dict[str, Any]


@dataclass(frozen=True, slots=True)
class AuditList(Page[AuditEntry]):
    """A page of the audit log, newest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[AuditEntry]
