"""Writes the figures of each bench module to the page when the module's tests have ended."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from tests.bench.page import Section


@pytest.fixture(scope="module", autouse=True)
def figures_on_the_page(request: pytest.FixtureRequest) -> Iterator[None]:
    """A failed bench writes nothing: the figures of its last good run stay."""
    failed = request.session.testsfailed
    yield
    section = getattr(request.module, "FIGURES", None)
    if isinstance(section, Section) and section.lines and request.session.testsfailed == failed:
        section.write()
