"""Calls that the service is too busy for are sent again."""

from __future__ import annotations

import io
from collections.abc import Callable

import httpx2
import pytest

from kinedex import Kinedex, KinedexError

BUSY = {"detail": "busy", "code": "too_busy", "status": 503, "errors": []}


def _client(answer: Callable[[httpx2.Request], httpx2.Response]) -> Kinedex:
    return Kinedex("http://service", transport=httpx2.MockTransport(answer))


def test_a_busy_service_is_called_again_with_the_whole_file() -> None:
    bodies: list[bytes] = []

    def answer(request: httpx2.Request) -> httpx2.Response:
        bodies.append(request.read())
        if len(bodies) < 3:
            return httpx2.Response(503, json=BUSY, headers={"Retry-After": "0"})
        return httpx2.Response(200, json={"clip": {}, "job": None})

    created = _client(answer).clips.upload(("a.bvh", io.BytesIO(b"content of a file")), task="walk")
    assert created.job is None
    assert len(bodies) == 3
    assert all(b"content of a file" in body and b"walk" in body for body in bodies)


@pytest.mark.parametrize("headers", [{"Retry-After": "0"}, {}])
def test_the_failure_is_raised_in_the_end(headers: dict[str, str]) -> None:
    calls: list[str] = []

    def answer(request: httpx2.Request) -> httpx2.Response:
        calls.append(request.url.path)
        return httpx2.Response(503, json=BUSY, headers=headers)

    with pytest.raises(KinedexError) as busy:
        _client(answer).clips.get("x")
    assert busy.value.code == "too_busy"
    assert len(calls) == (4 if headers else 1)


def test_an_answer_of_a_proxy_is_a_failure_too() -> None:
    client = _client(lambda _: httpx2.Response(502, text="<html>bad gateway"))
    with pytest.raises(KinedexError, match="The service answered 502: <html>bad gateway"):
        client.clips.get("x")


def test_the_key_is_sent_and_the_environment_names_the_service(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen: list[httpx2.Request] = []

    def answer(request: httpx2.Request) -> httpx2.Response:
        seen.append(request)
        return httpx2.Response(200, json={"status": "alive"})

    monkeypatch.setenv("KINEDEX_URL", "http://elsewhere/base/")
    monkeypatch.setenv("KINEDEX_API_KEY", "secret")
    Kinedex(transport=httpx2.MockTransport(answer)).service.alive()
    assert str(seen[0].url) == "http://elsewhere/base/livez"
    assert seen[0].headers["Authorization"] == "Bearer secret"
