"""Clients of the running demo service."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from app.demo import DemoClip, demo_clips
from kinedex import Kinedex
from tests.live import NO_TLS, Live


@pytest.fixture(scope="session")
def take() -> DemoClip:
    """A clip that the demo service does not have."""
    return next(demo_clips(["chika"], ["bow"], takes=1))


@pytest.fixture
def client(demo_service: Live) -> Iterator[Kinedex]:
    with Kinedex(demo_service.url, verify=NO_TLS, trust_env=False) as made:
        yield made
