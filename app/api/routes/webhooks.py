"""Webhooks: HTTP calls to other services when a job has ended."""

from __future__ import annotations

from fastapi import APIRouter, Depends

from app.api.bodies import require_json
from app.api.deps import Lib, administers
from app.api.guard.admission import changes, quick
from app.api.openapi import WebhookId, refusals
from app.api.schemas.webhooks import (
    NewWebhook,
    Webhook,
    WebhookCreated,
    WebhookList,
    WebhookPatch,
)
from app.errors import Conflict
from app.services.webhooks import registry

router = APIRouter(prefix="/v1/webhooks", tags=["webhooks"], dependencies=[administers])

_CREATE = """\
Call another service when a job has ended. This needs the role `admin`.

Each event is a POST with JSON: `{"type": "import.succeeded", "timestamp": ..., "data": {"id": ...,
"kind": ..., "state": ..., "clip_id": ..., "error": ...}}`. `data.id` is the id of the job. The
headers are those of [Standard Webhooks](https://www.standardwebhooks.com): `webhook-id`,
`webhook-timestamp`, and `webhook-signature` with HMAC-SHA256 of `id.timestamp.body`. Check the
signature, and refuse old timestamps.

An answer with a status from 200 to 299 within 15 seconds means that the event was received.
Redirects are not followed. Otherwise the event is sent again, after 5 seconds at first and after
6 hours at last. Each webhook receives its events in order. An event can arrive twice, with the
same id. After 16 failures in a row, or after the status 410, the webhook is switched off.
"""


@router.post(
    "",
    status_code=201,
    dependencies=[Depends(require_json), changes],
    description=_CREATE,
    responses=refusals(400, 413, 415, Conflict),
)
def create_webhook(lib: Lib, new: NewWebhook) -> WebhookCreated:
    """Create a webhook."""
    created = registry.create(lib, new.url, new.events, new.secret, is_enabled=new.enabled)
    return WebhookCreated.model_validate(created)


@router.get("", dependencies=[quick], responses=refusals())
def list_webhooks(lib: Lib) -> WebhookList:
    """All webhooks, each with the outcome of its last delivery."""
    return WebhookList.model_validate({"items": registry.list_webhooks(lib)})


@router.get("/{webhook_id}", dependencies=[quick], responses=refusals(404))
def get_webhook(lib: Lib, webhook_id: WebhookId) -> Webhook:
    """One webhook, with the outcome of its last delivery."""
    return Webhook.model_validate(registry.get(lib, webhook_id))


@router.patch(
    "/{webhook_id}",
    dependencies=[Depends(require_json), changes],
    responses=refusals(400, 404, 413, 415),
)
def update_webhook(lib: Lib, webhook_id: WebhookId, patch: WebhookPatch) -> Webhook:
    """Change the events, or switch a webhook on or off.

    A webhook that is off forgets the events that it still had to receive.
    """
    return Webhook.model_validate(registry.change(lib, webhook_id, patch.events, patch.enabled))


@router.post(
    "/{webhook_id}/test",
    status_code=202,
    dependencies=[changes],
    responses=refusals(404),
)
def test_webhook(lib: Lib, webhook_id: WebhookId) -> Webhook:
    """Send the event `webhook.test`, once if the webhook is switched off.

    `last_delivery` then shows whether it was received.
    """
    return Webhook.model_validate(registry.test(lib, webhook_id))


@router.delete("/{webhook_id}", status_code=204, dependencies=[changes], responses=refusals(404))
def delete_webhook(lib: Lib, webhook_id: WebhookId) -> None:
    """Delete a webhook. The events that it still had to receive are not sent."""
    registry.delete(lib, webhook_id)
