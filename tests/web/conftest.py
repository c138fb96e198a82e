"""What the tests of the pages share: a browser, and pages of the demo library in it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.live import Live
from tests.web.browser import launch, opened, why_not


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    reason = why_not()
    if reason is not None:
        pytest.skip(reason)
    with sync_playwright() as playwright:
        found = launch(playwright)
        yield found
        found.close()


@pytest.fixture
def page(browser: Browser, demo_service: Live) -> Iterator[Page]:
    """A page of the demo library, which tests must not change."""
    with opened(browser, demo_service.url) as page:
        yield page
