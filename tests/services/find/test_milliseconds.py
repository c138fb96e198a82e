"""The time that a search took is said to a microsecond: more digits say nothing."""

from __future__ import annotations

import pytest

from app.services.find import hits
from app.services.find.hits import milliseconds_since


def test_milliseconds_have_three_decimals(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hits.time, "perf_counter", lambda: 2.0)
    assert milliseconds_since(1.9987654321) == 1.235
