"""Events of webhooks are read only if the service signed them."""

from __future__ import annotations

import json
from datetime import timedelta

import pytest

from app.services.webhooks.sending import signed
from app.store.database.ids import utc_now
from kinedex import WrongSignature, read_event

SECRET = "whsec_HlW36lCAbNZ6Y76YkxldkICBGLHaw9yU"
EVENT = {"type": "ingest.succeeded", "data": {"id": "job_1"}}
BODY = json.dumps(EVENT).encode()


def test_a_signed_event_is_read() -> None:
    headers = signed("msg_1", SECRET, BODY, utc_now())
    assert read_event(headers, BODY, SECRET) == EVENT
    titled = {name.title(): value for name, value in headers.items()}
    both = titled | {"Webhook-Signature": f"v1,AAAA {headers['webhook-signature']}"}
    assert read_event(both, BODY, SECRET) == EVENT


def test_other_events_are_refused() -> None:
    headers = signed("msg_1", SECRET, BODY, utc_now())
    other = "whsec_" + "A" * 32
    old = signed("msg_1", SECRET, BODY, utc_now() - timedelta(hours=1))
    for sent, body, secret, reason in (
        (headers, BODY + b" ", SECRET, "not that of the secret"),
        (headers, BODY, other, "not that of the secret"),
        (headers | {"webhook-id": "msg_2"}, BODY, SECRET, "not that of the secret"),
        (headers | {"webhook-signature": ""}, BODY, SECRET, "not that of the secret"),
        (old, BODY, SECRET, "s old"),
        (headers | {"webhook-timestamp": "soon"}, BODY, SECRET, "cannot be used"),
        ({}, BODY, SECRET, "webhook-id"),
        (headers, BODY, "whsec_?", "cannot be used"),
    ):
        with pytest.raises(WrongSignature, match=reason):
            read_event(sent, body, secret)
    assert read_event(old, BODY, SECRET, tolerance=7200) == EVENT
