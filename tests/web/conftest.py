"""What the tests of the pages share: a browser, and pages of the demo library in it."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, sync_playwright

from tests.live import Live, serve_demo
from tests.web.browser import launch, opened, why_not


@pytest.fixture(scope="session")
def demo_service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A demo library of the pages' own: other tests add clips and models to theirs."""
    with serve_demo(tmp_path_factory.mktemp("demo-pages") / "data") as live:
        yield live


@pytest.fixture(scope="module")
def browser() -> Iterator[Browser]:
    """The browser. While it is there, an event loop runs in this thread: other modules use their
    own, so it ends with the module."""
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


@pytest.fixture(scope="session")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A demo library that tests may add to and correct, each what is its own."""
    with serve_demo(tmp_path_factory.mktemp("workshop") / "data") as live:
        yield live
