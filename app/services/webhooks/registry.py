"""Webhooks: create, list, change, delete and test them."""

from __future__ import annotations

import base64
import ipaddress
import secrets
from collections.abc import Collection
from urllib.parse import urlsplit

from app.config import ENV_PREFIX
from app.errors import Conflict
from app.services import fields
from app.services.library.library import Library
from app.store.jobs.endings import EVENTS
from app.store.webhooks import deliveries
from app.store.webhooks import repository as stored
from app.store.webhooks.deliveries import Event
from app.store.webhooks.repository import WebhookRecord

MAX_WEBHOOKS = 100
MAX_URL_LENGTH = 2000
SECRET_PREFIX = "whsec_"  # noqa: S105 - the prefix of every secret (Standard Webhooks)
SECRET_BYTES = (24, 64)
"""Least and most random bytes of a secret (Standard Webhooks)."""
TEST_EVENT = "webhook.test"
"""The event that `test` sends. All webhooks receive it."""
LOCALHOST = "localhost"


def create(
    lib: Library,
    url: str,
    events: Collection[str] = (),
    secret: str | None = None,
    *,
    is_enabled: bool = True,
) -> WebhookRecord:
    """Create a webhook. events: those that it receives, empty for all.

    secret: `whsec_` and 24 to 64 bytes in base64; None makes one. Raises BadField, Conflict if
    there are MAX_WEBHOOKS already.
    """
    _check_url(url, allow_http=lib.settings.webhook_http)
    _check_events(events)
    signs = _new_secret() if secret is None else _checked_secret(secret)

    with lib.store.write() as tx:
        if len(stored.list_all(tx)) >= MAX_WEBHOOKS:
            raise Conflict(f"There are {MAX_WEBHOOKS} webhooks already; delete one first.")
        return stored.add(tx, url, signs, events, is_enabled=is_enabled)


def list_webhooks(lib: Library) -> tuple[WebhookRecord, ...]:
    """All webhooks, the newest first."""
    with lib.store.read() as tx:
        return stored.list_all(tx)


def get(lib: Library, webhook_id: str) -> WebhookRecord:
    """A webhook by id. Raises WebhookNotFound."""
    with lib.store.read() as tx:
        return stored.get(tx, webhook_id)


def change(
    lib: Library,
    webhook_id: str,
    events: Collection[str] | None = None,
    is_enabled: bool | None = None,
) -> WebhookRecord:
    """Change the events, or switch a webhook on or off. Raises BadField, WebhookNotFound."""
    _check_events(events or ())
    with lib.store.write() as tx:
        return stored.change(tx, webhook_id, events=events, is_enabled=is_enabled)


def delete(lib: Library, webhook_id: str) -> None:
    """Delete a webhook and the events that it still had to receive. Raises WebhookNotFound."""
    with lib.store.write() as tx:
        stored.remove(tx, webhook_id)


def test(lib: Library, webhook_id: str) -> WebhookRecord:
    """Queue a test event for a webhook. It is sent once if the webhook is off.

    Raises WebhookNotFound.
    """
    with lib.store.write() as tx:
        stored.get(tx, webhook_id)
        deliveries.add(tx, webhook_id, Event(TEST_EVENT, {"webhook_id": webhook_id}))
        return stored.get(tx, webhook_id)


def secret_bytes(secret: str) -> bytes:
    """The key of a secret, for the signature. Raises ValueError if it is malformed."""
    return base64.b64decode(secret.removeprefix(SECRET_PREFIX), validate=True)


def _new_secret() -> str:
    return SECRET_PREFIX + base64.b64encode(secrets.token_bytes(SECRET_BYTES[0])).decode("ascii")


def _checked_secret(secret: str) -> str:
    least, most = SECRET_BYTES
    try:
        fits = secret.startswith(SECRET_PREFIX) and least <= len(secret_bytes(secret)) <= most
    except ValueError:
        fits = False
    if not fits:
        message = f"must be {SECRET_PREFIX} and {least} to {most} random bytes in base64"
        raise fields.bad_field("secret", message)
    return secret


def _check_events(events: Collection[str]) -> None:
    for event in events:
        if event not in EVENTS:
            raise fields.bad_field("events", f"{event!r} is none of {', '.join(EVENTS)}")


def _check_url(url: str, *, allow_http: bool) -> None:
    """Raises BadField unless the address is https, or http on this machine.

    Without TLS, anybody on the way could read and forge events. It is also what keeps a client
    from using Kinedex to call services inside of the network, most of which have no TLS.
    """
    try:
        parts = urlsplit(url)
        host, _ = parts.hostname, parts.port
    except ValueError as error:
        raise fields.bad_field("url", "is no address of the web") from error
    is_plain = parts.scheme == "http" and (allow_http or _is_this_machine(host or ""))
    if not host or not (parts.scheme == "https" or is_plain):
        message = (
            "must begin with https://, or with http:// and be on this machine"
            f" ({ENV_PREFIX}WEBHOOK_HTTP allows http:// everywhere)"
        )
        raise fields.bad_field("url", message)
    if len(url) > MAX_URL_LENGTH or not url.isascii() or not url.isprintable() or " " in url:
        raise fields.bad_field("url", f"must be printable ASCII, at most {MAX_URL_LENGTH} long")
    if parts.username is not None or parts.fragment:
        raise fields.bad_field("url", "must have no user name and no fragment")


def _is_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == LOCALHOST
