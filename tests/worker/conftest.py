"""Demo clips that the tests of the worker share."""

from __future__ import annotations

import pytest

from app.demo import DemoClip, demo_clips


@pytest.fixture(scope="session")
def kicks() -> list[DemoClip]:
    return list(demo_clips(tasks=("kick",), takes=2))
