"""Answers: webhooks. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Literal

from kinedex.records import Page, Record


@dataclass(frozen=True, slots=True)
class LastDelivery(Record):
    """The last try to send an event.

    id: The id of the event, as in the header `webhook-id`.
    attempt: Number of this try for this event, from 1.
    status: HTTP status of the answer; null without an answer.
    detail: Why it failed.
    """

    id: str
    event: str
    state: Literal["delivered", "failed"]
    attempt: int
    status: int | None
    detail: str | None
    at: datetime


@dataclass(frozen=True, slots=True)
class Webhook(Record):
    """A webhook. Its secret is shown only when it is created.

    events: Events that are sent. An empty list: all events.
    enabled: Whether events are sent. Kinedex sets it to false after many failures in a row, or
    if the receiver answers 410.
    failures: Failed tries since the last success.
    pending: Number of events that are still to be sent.
    """

    id: str
    url: str
    events: list[str]
    enabled: bool
    failures: int
    pending: int
    last_delivery: LastDelivery | None
    created_at: datetime


@dataclass(frozen=True, slots=True)
class WebhookCreated(Record):
    """A new webhook with its secret, which is not shown again.

    events: Events that are sent. An empty list: all events.
    enabled: Whether events are sent. Kinedex sets it to false after many failures in a row, or
    if the receiver answers 410.
    failures: Failed tries since the last success.
    pending: Number of events that are still to be sent.
    """

    id: str
    url: str
    events: list[str]
    enabled: bool
    failures: int
    pending: int
    last_delivery: LastDelivery | None
    created_at: datetime
    secret: str


@dataclass(frozen=True, slots=True)
class WebhookList(Page[Webhook]):
    """All webhooks, the newest first; `next` is always null."""

    items: list[Webhook]
    next: str | None
