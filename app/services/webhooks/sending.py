"""Sends one event to one webhook, signed as Standard Webhooks says.

By http.client of the standard library, and not by a library with more comfort: it follows no
redirects, reads no proxy settings and decodes no bodies, so that a receiver can lead us nowhere.
Source: https://www.standardwebhooks.com (specification 1.0.0).
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import http.client
import socket
import ssl
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from datetime import datetime
from urllib.parse import urlsplit

from app.services.webhooks.registry import secret_bytes
from app.store.webhooks.deliveries import Delivery, Outcome

STEP_SECONDS = 5.0
"""To connect, and for each piece of the answer."""
TOTAL_SECONDS = 15.0
"""For the whole call, however slowly the receiver answers."""
GONE = 410
"""The receiver wants no events any more."""


def send(delivery: Delivery, now: datetime) -> Outcome:
    """Send an event. A status of 200 to 299 counts as delivered. Never raises."""
    body = delivery.body.encode("utf-8")
    headers = {
        "Content-Type": "application/json",
        "User-Agent": "Kinedex",
        "Connection": "close",
        **signed(delivery.id, delivery.secret, body, now),
    }
    try:
        status = _post(delivery.url, body, headers)
    except (OSError, http.client.HTTPException, ValueError) as error:
        return Outcome(is_delivered=False, status=None, detail=_told(error))
    if 200 <= status < 300:
        return Outcome(is_delivered=True, status=status)
    detail = f"The receiver answered {status}."
    return Outcome(is_delivered=False, status=status, detail=detail, is_gone=status == GONE)


def signed(event_id: str, secret: str, body: bytes, now: datetime) -> dict[str, str]:
    """Return the headers that name and sign an event.

    The signature is HMAC-SHA256 of `id.timestamp.body`; timestamp: seconds since 1970.
    """
    timestamp = str(int(now.timestamp()))
    content = f"{event_id}.{timestamp}.".encode() + body
    digest = hmac.new(secret_bytes(secret), content, hashlib.sha256).digest()
    return {
        "webhook-id": event_id,
        "webhook-timestamp": timestamp,
        "webhook-signature": f"v1,{base64.b64encode(digest).decode('ascii')}",
    }


def _post(url: str, body: bytes, headers: dict[str, str]) -> int:
    """Return the status of the answer; its body is not read. Raises OSError, HTTPException."""
    parts = urlsplit(url)
    host = parts.hostname or ""
    connection = (
        http.client.HTTPSConnection(
            host, parts.port, timeout=STEP_SECONDS, context=ssl.create_default_context()
        )
        if parts.scheme == "https"
        else http.client.HTTPConnection(host, parts.port, timeout=STEP_SECONDS)
    )
    target = (parts.path or "/") + (f"?{parts.query}" if parts.query else "")
    with _cut_off(connection):
        connection.request("POST", target, body=body, headers=headers)
        return connection.getresponse().status


@contextmanager
def _cut_off(connection: http.client.HTTPConnection) -> Iterator[None]:
    """End the call after TOTAL_SECONDS: the timeout of a socket counts anew for each piece."""

    def shut_down() -> None:
        with suppress(OSError):
            if connection.sock is not None:
                connection.sock.shutdown(socket.SHUT_RDWR)

    timer = threading.Timer(TOTAL_SECONDS, shut_down)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        connection.close()


def _told(error: Exception) -> str:
    """What went wrong, without what the receiver sent."""
    if isinstance(error, TimeoutError):
        return f"The receiver did not answer within {STEP_SECONDS:.0f} s."
    if isinstance(error, ssl.SSLError):
        return f"The TLS connection failed: {error.reason}."
    if isinstance(error, OSError) and error.strerror:
        return f"The receiver cannot be reached: {error.strerror}."
    return f"The receiver cannot be reached ({type(error).__name__})."
