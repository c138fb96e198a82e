"""Fixtures that the tests of the HTTP API share."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip, demo_clips
from tests.live import Live


@pytest.fixture(scope="session")
def take() -> DemoClip:
    """A clip that the demo service does not have."""
    return next(demo_clips(["chika"], ["walk"], takes=1))


@pytest.fixture
def idle(idle_service: Live) -> Iterator[httpx2.Client]:
    with idle_service.client() as client:
        yield client


@pytest.fixture
def demo(demo_service: Live) -> Iterator[httpx2.Client]:
    with demo_service.client() as client:
        yield client


@pytest.fixture
def walk(demo: httpx2.Client) -> dict[str, Any]:
    """A ready clip of someone who walks."""
    clip: dict[str, Any] = demo.get("/v1/clips", params={"task": "walk"}).json()["items"][0]
    return clip


def assert_problem(answer: httpx2.Response, status: int, code: str, *locations: str) -> None:
    """Check an RFC 9457 problem: its status, its code, and locations that it must name."""
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    problem = answer.json()
    assert list(problem) == ["type", "title", "status", "detail", "code", "errors"]
    assert (problem["status"], problem["code"]) == (status, code)
    assert problem["type"] == f"urn:kinedex:problem:{code}"
    assert set(locations) <= {place["location"] for place in problem["errors"]}
    assert all(set(place) == {"location", "message"} for place in problem["errors"])
