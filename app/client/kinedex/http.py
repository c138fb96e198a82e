"""How calls become HTTP requests, and when a request is sent again."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import httpx2

from kinedex.call import JSON, Call
from kinedex.errors import KinedexError, Unreachable, failure_of
from kinedex.sent import UNSET, form_text, is_repeatable, opened, query_texts

TIMEOUT = httpx2.Timeout(120.0, connect=10.0)
"""Seconds. The service ends calls after 30 s; large uploads and exports take longer."""
RETRIES = 3
MAX_RETRY_S = 30.0
"""The longest pause before a call is sent again, seconds."""
BUSY, LIMITED = 503, 429


def options(url: str, api_key: str | None, extra: dict[str, Any]) -> dict[str, Any]:
    """The arguments of an httpx2 client for the service at `url`."""
    headers = {"Accept": JSON} | ({"Authorization": f"Bearer {api_key}"} if api_key else {})
    return {"base_url": url.rstrip("/"), "headers": headers, "timeout": TIMEOUT} | extra


@contextmanager
def request_of(
    client: httpx2.Client | httpx2.AsyncClient, call: Call[Any]
) -> Iterator[httpx2.Request]:
    """The request of a call; its files are open within the block."""
    headers = {"Accept": call.accept}
    arguments: dict[str, Any] = {"params": query_texts(call.query), "headers": headers}
    arguments["extensions"] = {"operation": call.operation}
    with opened(call.files, call.progress) as files:
        if files:
            arguments["files"] = files
            arguments["data"] = {name: form_text(one) for name, one in call.fields.items()}
        elif call.json is not UNSET:
            headers["Content-Type"] = JSON
            arguments["content"] = json.dumps(call.json)
        yield client.build_request(call.method, call.path, **arguments)


def pause_before_retry(response: httpx2.Response, call: Call[Any], attempt: int) -> float | None:
    """Seconds to wait before the call is sent again; None if it must not be sent again."""
    status = response.status_code
    if status not in {BUSY, LIMITED} or attempt >= RETRIES or not is_repeatable(call.files):
        return None
    after = failure_of(status, b"", response.headers.get("Retry-After")).retry_after
    if after is None or (status == LIMITED and after > MAX_RETRY_S):
        return None
    return min(after, MAX_RETRY_S)


def answer_of(response: httpx2.Response, call: Call[Any]) -> Any:
    """The answer of a call. Raises KinedexError with the members of the problem."""
    if response.is_success:
        return call.read(response)
    raise failure_of(response.status_code, response.content, response.headers.get("Retry-After"))


@contextmanager
def transport_failures(url: str) -> Iterator[None]:
    """Raise Unreachable for failures of the connection. Without it, nothing changes."""
    try:
        yield
    except httpx2.TimeoutException as failure:
        raise _unreachable(f"{url} did not answer in time", failure) from failure
    except httpx2.TransportError as failure:
        raise _unreachable(f"{url} cannot be reached: {failure}", failure) from failure
    except (httpx2.InvalidURL, httpx2.UnsupportedProtocol) as failure:
        raise _unreachable(f"{url!r} is not an address: {failure}", failure) from failure


def _unreachable(detail: str, failure: Exception) -> KinedexError:
    return Unreachable(detail, code="unreachable", title=type(failure).__name__)
