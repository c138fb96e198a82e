"""Checks and reads the events that a service sends to webhooks (Standard Webhooks 1.0.0)."""

from __future__ import annotations

import base64
import binascii
import hashlib
import hmac
import json
import time
from collections.abc import Mapping
from typing import Any

SECRET_PREFIX = "whsec_"  # noqa: S105 - every secret begins with it
VERSION = "v1,"
TOLERANCE_S = 300.0
"""Seconds between the clocks of the service and of the receiver. An older event may be a repeated
one."""


class WrongSignature(ValueError):
    """The call does not come from the service that has the secret, or is too old."""


def read_event(
    headers: Mapping[str, str], body: bytes, secret: str, tolerance: float = TOLERANCE_S
) -> dict[str, Any]:
    """The event of a call that arrived at a webhook: `type`, `timestamp` and `data`.

    headers: in upper or lower case. body: as it arrived. secret: of the webhook, as
    `client.webhooks.create` returned it. Raises WrongSignature.
    """
    lower = {name.lower(): value for name, value in headers.items()}
    try:
        event_id, sent_at = lower["webhook-id"], lower["webhook-timestamp"]
        signatures = lower["webhook-signature"].split()
        age = abs(time.time() - int(sent_at))
        key = base64.b64decode(secret.removeprefix(SECRET_PREFIX), validate=True)
    except (KeyError, ValueError, binascii.Error) as problem:
        raise WrongSignature(f"A header or the secret cannot be used: {problem}") from None
    if age > tolerance:
        raise WrongSignature(f"The event is {age:.0f} s old.")
    digest = hmac.new(key, f"{event_id}.{sent_at}.".encode() + body, hashlib.sha256).digest()
    expected = VERSION + base64.b64encode(digest).decode()
    # compare_digest: the time that it takes does not show how much of a guess was right
    if not any(hmac.compare_digest(expected.encode(), one.encode()) for one in signatures):
        raise WrongSignature("The signature is not that of the secret.")
    event: dict[str, Any] = json.loads(body)
    return event
