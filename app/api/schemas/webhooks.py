"""Webhooks."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, ConfigDict, Field, StrictBool

from app.api.schemas.base import Incoming, Outgoing
from app.services.webhooks.registry import MAX_URL_LENGTH, MAX_WEBHOOKS
from app.store.jobs.endings import EVENTS

MAX_SECRET_LENGTH = 100
_NAMES = ", ".join(f"`{event}`" for event in EVENTS)
Events = Annotated[
    list[Annotated[str, Field(max_length=50, json_schema_extra={"enum": list(EVENTS)})]],
    Field(
        max_length=len(EVENTS),
        description=f"Events that are sent: {_NAMES}. An empty list: all events.",
    ),
]


def _none_as_no_list(value: Any) -> Any:
    return [] if value is None else value


class NewWebhook(Incoming):
    """A webhook to create."""

    url: str = Field(
        min_length=1,
        max_length=MAX_URL_LENGTH,
        description="Where events are sent by POST. `https://`, or `http://` on this machine.",
    )
    events: Events = Field(default_factory=list)
    secret: str | None = Field(
        None,
        max_length=MAX_SECRET_LENGTH,
        description="`whsec_` and 24 to 64 random bytes in base64. Default: a new one.",
    )
    enabled: StrictBool = Field(True, description="False: nothing is sent until it is switched on.")

    model_config = ConfigDict(
        json_schema_extra={
            "examples": [
                {
                    "url": "https://example.com/kinedex",
                    "events": ["import.succeeded", "import.failed"],
                    "enabled": False,
                }
            ]
        }
    )


class WebhookPatch(Incoming):
    """Changes of a webhook. Only the sent fields change."""

    events: Annotated[Events, BeforeValidator(_none_as_no_list)] | None = None
    enabled: StrictBool | None = Field(
        None, description="true also tries a failing webhook again at once."
    )

    model_config = ConfigDict(json_schema_extra={"examples": [{"events": ["fit.succeeded"]}]})


class LastDelivery(Outgoing):
    """The last try to send an event."""

    id: str = Field(description="The id of the event, as in the header `webhook-id`.")
    event: str
    state: Literal["delivered", "failed"]
    attempt: int = Field(description="Number of this try for this event, from 1.")
    status: int | None = Field(description="HTTP status of the answer; null without an answer.")
    detail: str | None = Field(description="Why it failed.")
    at: datetime


class Webhook(Outgoing):
    """A webhook. Its secret is shown only when it is created."""

    id: str
    url: str
    events: list[str] = Field(description="Events that are sent. An empty list: all events.")
    enabled: bool = Field(
        validation_alias="is_enabled",
        description="Whether events are sent. Kinedex sets it to false after many failures in a "
        "row, or if the receiver answers 410.",
    )
    failures: int = Field(description="Failed tries since the last success.")
    pending: int = Field(description="Number of events that are still to be sent.")
    last_delivery: LastDelivery | None
    created_at: datetime


class WebhookCreated(Webhook):
    """A new webhook with its secret, which is not shown again."""

    secret: str


class WebhookList(Outgoing):
    """All webhooks, the newest first; `next` is always null."""

    items: list[Webhook] = Field(max_length=MAX_WEBHOOKS)
    next: str | None = None
