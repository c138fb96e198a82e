"""Calls: webhooks. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from kinedex.call import Call, nothing, path_of, record
from kinedex.sent import UNSET, Unset, corrections, given

if TYPE_CHECKING:
    from kinedex.types.webhooks import Webhook, WebhookCreated, WebhookList


def list_webhooks() -> Call[WebhookList]:
    """All webhooks, each with the outcome of its last delivery."""
    from kinedex.types.webhooks import WebhookList

    return Call("list_webhooks", "GET", "/v1/webhooks", record(WebhookList))


def create_webhook(
    url: str,
    *,
    events: Sequence[
        Literal[
            "ingest.succeeded",
            "ingest.failed",
            "ingest.canceled",
            "import.succeeded",
            "import.failed",
            "import.canceled",
            "fit.succeeded",
            "fit.failed",
            "fit.canceled",
            "evaluate.succeeded",
            "evaluate.failed",
            "evaluate.canceled",
        ]
    ]
    | None = None,
    secret: str | None = None,
    enabled: bool | None = None,
) -> Call[WebhookCreated]:
    """Call another service when a job has ended. This needs the role `admin`.

    Each event is a POST with JSON: `{"type": "import.succeeded", "timestamp": ..., "data":
    {"id": ..., "kind": ..., "state": ..., "clip_id": ..., "error": ...}}`. `data.id` is the id
    of the job. The headers are those of [Standard Webhooks](https://www.standardwebhooks.com):
    `webhook-id`, `webhook-timestamp`, and `webhook-signature` with HMAC-SHA256 of
    `id.timestamp.body`. Check the signature, and refuse old timestamps.

    An answer with a status from 200 to 299 within 15 seconds means that the event was received.
    Redirects are not followed. Otherwise the event is sent again, after 5 seconds at first and
    after 6 hours at last. Each webhook receives its events in order. An event can arrive twice,
    with the same id. After 16 failures in a row, or after the status 410, the webhook is
    switched off.

    url: Where events are sent by POST. `https://`, or `http://` on this machine.
    events: Events that are sent: `ingest.succeeded`, `ingest.failed`, `ingest.canceled`,
        `import.succeeded`, `import.failed`, `import.canceled`, `fit.succeeded`, `fit.failed`,
        `fit.canceled`, `evaluate.succeeded`, `evaluate.failed`, `evaluate.canceled`. An empty
        list: all events.
    secret: `whsec_` and 24 to 64 random bytes in base64. Default: a new one.
    enabled: False: nothing is sent until it is switched on. Default: True.
    """
    from kinedex.types.webhooks import WebhookCreated

    return Call(
        "create_webhook",
        "POST",
        "/v1/webhooks",
        record(WebhookCreated),
        json=given(url=url, events=events, secret=secret, enabled=enabled),
    )


def get_webhook(webhook_id: str) -> Call[Webhook]:
    """One webhook, with the outcome of its last delivery."""
    from kinedex.types.webhooks import Webhook

    return Call(
        "get_webhook",
        "GET",
        path_of("/v1/webhooks/{webhook_id}", webhook_id=webhook_id),
        record(Webhook),
    )


def update_webhook(
    webhook_id: str,
    *,
    events: Sequence[
        Literal[
            "ingest.succeeded",
            "ingest.failed",
            "ingest.canceled",
            "import.succeeded",
            "import.failed",
            "import.canceled",
            "fit.succeeded",
            "fit.failed",
            "fit.canceled",
            "evaluate.succeeded",
            "evaluate.failed",
            "evaluate.canceled",
        ]
    ]
    | Unset
    | None = UNSET,
    enabled: bool | Unset | None = UNSET,
) -> Call[Webhook]:
    """Change the events, or switch a webhook on or off.

    A webhook that is off forgets the events that it still had to receive.

    enabled: true also tries a failing webhook again at once.
    """
    from kinedex.types.webhooks import Webhook

    return Call(
        "update_webhook",
        "PATCH",
        path_of("/v1/webhooks/{webhook_id}", webhook_id=webhook_id),
        record(Webhook),
        json=corrections(events=events, enabled=enabled),
    )


def delete_webhook(webhook_id: str) -> Call[None]:
    """Delete a webhook. The events that it still had to receive are not sent."""
    return Call(
        "delete_webhook",
        "DELETE",
        path_of("/v1/webhooks/{webhook_id}", webhook_id=webhook_id),
        nothing,
    )


def test_webhook(webhook_id: str) -> Call[Webhook]:
    """Send the event `webhook.test`, once if the webhook is switched off.

    `last_delivery` then shows whether it was received.
    """
    from kinedex.types.webhooks import Webhook

    return Call(
        "test_webhook",
        "POST",
        path_of("/v1/webhooks/{webhook_id}/test", webhook_id=webhook_id),
        record(Webhook),
    )
