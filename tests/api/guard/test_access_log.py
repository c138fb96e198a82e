"""The line of a request names the client and the key's public id, never the key."""

from __future__ import annotations

import logging
from typing import Any

import pytest

from app.api.guard.access_log import log_request
from app.api.guard.callers import MAX_ADDRESS_LENGTH, Caller
from app.store.database.ids import utc_now
from app.store.keys import KeyRecord, KeyRole


def logged(caplog: pytest.LogCaptureFixture, **scope: Any) -> dict[str, Any]:
    """The fields of the line for a request with these members of its scope."""
    caplog.set_level(logging.INFO)
    log_request({"method": "GET", "path": "/v1/clips", "type": "http", **scope}, 200, 0.0123)
    fields: dict[str, Any] = caplog.records[-1].fields  # type: ignore[attr-defined]
    return fields


def test_a_call_with_a_key_is_logged_with_the_id_of_the_key(
    caplog: pytest.LogCaptureFixture,
) -> None:
    key = KeyRecord("0123456789ab", "a", KeyRole.READ, utc_now(), None)
    caller = Caller(has_key=True, is_free=False, key=key)
    assert logged(caplog, client=("192.0.2.7", 51234), state={"caller": caller}) == {
        "client": "192.0.2.7",
        "method": "GET",
        "path": "/v1/clips",
        "status": 200,
        "ms": 12.3,
        "key_id": "0123456789ab",
    }


@pytest.mark.parametrize(
    "caller", [None, Caller(has_key=True, is_free=False), Caller(has_key=False, is_free=True)]
)
def test_a_call_without_a_valid_key_is_logged_without_an_id(
    caplog: pytest.LogCaptureFixture, caller: Caller | None
) -> None:
    state = {} if caller is None else {"caller": caller}
    assert "key_id" not in logged(caplog, client=("::1", 1), state=state)


def test_addresses_may_be_missing_or_any_text(caplog: pytest.LogCaptureFixture) -> None:
    assert logged(caplog)["client"] is None
    assert logged(caplog, client=None)["client"] is None
    assert len(logged(caplog, client=("x" * 1000, 0))["client"]) == MAX_ADDRESS_LENGTH
