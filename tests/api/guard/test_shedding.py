"""A full queue of heavy calls refuses the next search before anything of it is read."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from fastapi.routing import APIRoute

from app.api.app import ROUTES
from app.api.guard.admission import Admission, Kind
from app.api.guard.gates import Gate
from app.api.guard.shedding import SHED, Shedding


def _asked(gate: Gate, method: str, path: str) -> list[dict[str, Any]]:
    """The messages of the answer; the application behind answers 200 without reading the body."""
    sent: list[dict[str, Any]] = []

    async def receive() -> dict[str, Any]:
        raise AssertionError("the body was read")

    async def send(message: Any) -> None:
        sent.append(message)

    async def application(_scope: Any, _receive: Any, _send: Any) -> None:
        await send({"type": "http.response.start", "status": 200, "headers": []})

    state = SimpleNamespace(gates=SimpleNamespace(heavy=gate))
    scope = {"type": "http", "method": method, "path": path, "app": SimpleNamespace(state=state)}
    asyncio.run(Shedding(application)(scope, receive, send))
    return sent


@pytest.mark.parametrize("path", sorted(SHED))
def test_searches_are_refused_while_the_queue_is_full(path: str) -> None:
    start, body = _asked(Gate("heavy", slots=0, waiting=0), "POST", path)
    assert start["status"] == 503
    assert (b"retry-after", b"1") in start["headers"]
    assert b'"code":"too_busy"' in body["body"]


def test_other_calls_and_a_queue_with_room_are_not() -> None:
    full, free = Gate("heavy", slots=0, waiting=0), Gate("heavy", slots=1, waiting=0)
    assert _asked(free, "POST", "/v1/search/motion")[0]["status"] == 200
    assert _asked(Gate("heavy", slots=0, waiting=1), "POST", "/v1/search")[0]["status"] == 200
    assert _asked(full, "GET", "/v1/search/motion")[0]["status"] == 200
    assert _asked(full, "POST", "/v1/clips")[0]["status"] == 200


def test_only_heavy_calls_are_refused() -> None:
    heavy = {
        route.path
        for module in ROUTES
        for route in module.router.routes
        if isinstance(route, APIRoute) and "POST" in (route.methods or ())
        for needed in route.dependencies
        if isinstance(needed.dependency, Admission) and needed.dependency.kind is Kind.HEAVY
    }
    assert heavy >= SHED
