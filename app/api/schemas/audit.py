"""The audit log."""

from __future__ import annotations

from datetime import UTC, datetime
from typing import Annotated, Any

from pydantic import AfterValidator, AwareDatetime, BeforeValidator, Field

from app.api.schemas.base import Cursor, Id, Incoming, Limit, Outgoing, Paged
from app.store.audit import AuditFilter

MAX_ACTION_LENGTH = 100


def _in_utc(time: datetime) -> datetime:
    try:
        return time.astimezone(UTC)
    except OverflowError:  # in the year 1 or 9999 of another time zone
        return (datetime.min if time.year == 1 else datetime.max).replace(tzinfo=UTC)


def _not_a_number(value: object) -> object:
    """pydantic takes a number for seconds since 1970; the description has times only."""
    try:
        float(str(value))
    except ValueError:
        return value
    raise ValueError("must be a time as 2026-11-30T12:00:00Z")


Time = Annotated[AwareDatetime, BeforeValidator(_not_a_number), AfterValidator(_in_utc)]


class AuditEntry(Outgoing):
    """A change or an export, by whom and when."""

    id: str
    at: datetime
    action: str = Field(
        description="The operation of this API, as `update_clip`, `forget_person` or `get_export`;"
        " or the command, as `kinedex keys create`."
    )
    key_id: str | None = Field(description="The API key; null without one.")
    key_name: str | None = Field(description="The name of the key.")
    address: str | None = Field(
        description="The client's address; null for a command on the machine of the library."
    )
    clip_id: str | None = Field(description="The clip that it is about.")
    details: dict[str, Any] = Field(
        description="Ids, names of changed fields and counts. No labels: a forgotten person's name"
        " is not in the log."
    )


class AuditList(Paged):
    """A page of the audit log, newest first."""

    items: list[AuditEntry]


class AuditQuery(Incoming):
    """Filters of the audit log, and a page of it."""

    since: Time | None = Field(None, description="Not before this time (ISO 8601).")
    until: Time | None = Field(None, description="Before this time.")
    key: Id | None = Field(None, description="Id of an API key.")
    action: Annotated[str, Field(min_length=1, max_length=MAX_ACTION_LENGTH)] | None = None
    clip: Id | None = Field(None, description="Id of a clip, which may be deleted.")
    limit: Limit = 100
    cursor: Cursor | None = None

    def as_filter(self) -> AuditFilter:
        """The filter of the store."""
        return AuditFilter(self.since, self.until, self.key, self.action, self.clip)
