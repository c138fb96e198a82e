"""Unexpected exceptions are logged with their request, and no client sees their text."""

from __future__ import annotations

import asyncio
import errno
import json
import logging
from typing import Any

import pytest
from starlette.requests import ClientDisconnect
from starlette.types import Message, Receive, Scope, Send

from app.api.failures.problems import TooBusy
from app.api.guard.arrival import Arrival
from app.api.guard.envelope import Envelope
from app.api.guard.slots import Slots
from app.logs import JsonFormatter, request_id


def _call(error: Exception) -> tuple[list[Message], list[str]]:
    """The sent messages and the JSON log lines when the application raises `error`."""
    sent: list[Message] = []
    lines: list[str] = []

    async def application(scope: Scope, receive: Receive, send: Send) -> None:
        raise error

    async def receive() -> Message:
        return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    handler = logging.Handler()
    handler.emit = lambda record: lines.append(JsonFormatter().format(record))  # type: ignore[method-assign]
    logger = logging.getLogger("app.api")
    logger.addHandler(handler)
    scope = {"type": "http", "method": "GET", "path": "/x", "headers": [(b"x-request-id", b"r1")]}
    try:
        asyncio.run(Envelope(application)(scope, receive, send))
    finally:
        logger.removeHandler(handler)
    return sent, lines


def _problem(sent: list[Message]) -> dict[str, Any]:
    problem: dict[str, Any] = json.loads(sent[1]["body"])
    return problem


def test_an_unexpected_exception_is_a_500_without_its_text() -> None:
    sent, lines = _call(RuntimeError("the secret of /etc"))
    assert sent[0]["status"] == 500
    assert _problem(sent)["code"] == "internal"
    assert "secret" not in str(sent)
    (line,) = [problem for problem in map(json.loads, lines) if "exception" in problem]
    assert "the secret of /etc" in line["exception"]
    assert line["request_id"] == "r1"
    assert request_id.get() is None


def test_a_full_disk_is_a_507() -> None:
    sent, _ = _call(OSError(errno.ENOSPC, "No space left"))
    assert (sent[0]["status"], _problem(sent)["code"]) == (507, "disk_full")


def test_a_client_that_leaves_is_not_logged_as_an_error() -> None:
    sent, lines = _call(ClientDisconnect())
    assert sent == []
    assert [json.loads(line)["level"] for line in lines] == ["info"] * len(lines)


def test_slots_limit_the_bodies_at_once() -> None:
    slots = Slots(1)
    with slots.one(Arrival()), pytest.raises(TooBusy), slots.one(Arrival()):
        pass
    with slots.one(Arrival()):
        pass
