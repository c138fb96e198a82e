"""The shell around all pages: navigation, themes, the banner, signing in."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from app.api.guard.page_paths import PAGE_NAMES
from app.config import load_settings
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from tests.live import Live, serve
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened

NAMED = ["", *(name for name in PAGE_NAMES if name not in {"clips", "compare", "study"})]
"""The pages that the navigation lists, in its order."""


def test_every_page_opens_by_its_address_and_from_the_navigation(page: Page) -> None:
    page.goto("/search")
    links = page.get_by_role("navigation", name="Pages").locator("li a")
    expect(links).to_have_count(len(NAMED))
    for place, name in enumerate(NAMED):
        links.nth(place).click()
        expect(page).to_have_url(re.compile(rf"/{name}(\?|$)"))
        expect(links.nth(place)).to_have_attribute("aria-current", "page")
        expect(page.locator("h1")).to_be_focused()
    title = page.locator("h1").text_content()
    page.reload()
    expect(page.locator("h1")).to_have_text(title or "")
    page.go_back()
    expect(links.nth(len(NAMED) - 2)).to_have_attribute("aria-current", "page")
    page.go_forward()
    expect(page.locator("h1")).to_have_text(title or "")


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_the_shell_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        page.goto("/search")
        expect(page.locator("h1")).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_keyboard_skips_the_navigation(page: Page) -> None:
    page.goto("/search")
    expect(page.locator("h1")).to_be_visible()
    page.keyboard.press("Tab")
    expect(page.get_by_text("Skip to the content")).to_be_focused()
    page.keyboard.press("Enter")
    expect(page.locator("main")).to_be_focused()


def test_the_theme_that_is_chosen_stays(page: Page) -> None:
    page.goto("/search")
    background = "getComputedStyle(document.documentElement).backgroundColor"
    light = page.evaluate(background)
    page.get_by_role("button", name="Dark theme").click()
    dark = page.evaluate(background)
    assert dark != light
    page.reload()
    expect(page.get_by_role("button", name="Dark theme")).to_have_attribute("aria-pressed", "true")
    assert page.evaluate(background) == dark


def test_a_service_that_is_away_is_said_and_found_again(
    browser: Browser, demo_service: Live
) -> None:
    with opened(browser, demo_service.url, expected=("Failed to load", "/v1/", "/livez")) as page:
        page.goto("/")
        expect(page.locator("h1")).to_be_visible()
        page.route("**/v1/**", lambda route: route.abort())
        page.route("**/livez", lambda route: route.abort())
        page.get_by_role("navigation").get_by_role("link", name="Search").click()
        page.get_by_role("navigation").get_by_role("link", name="Gallery", exact=True).click()
        page.get_by_role("searchbox").fill("kick")
        expect(page.get_by_text("Kinedex does not answer.")).to_be_visible()
        expect(page.get_by_role("button", name="Try now")).to_be_visible()
        page.unroute_all()
        expect(page.get_by_text("Kinedex does not answer.")).to_be_hidden()
        expect(page.get_by_role("searchbox")).to_have_value("kick")


def test_where_keys_are_asked_for_a_key_signs_in(browser: Browser, tmp_path: Path) -> None:
    with serve(tmp_path / "data") as live:
        settings = load_settings(data_dir=live.data_dir)
        store = Store.open(settings.database, settings.files_dir)
        with store.write() as tx:
            secret = keys.create(tx, KeyRole.WRITE, "for the test").secret
        store.close()
        with opened(browser, live.url, expected=("401",)) as page:
            page.goto("/")
            field = page.get_by_label("API key")
            field.fill("wrong")
            page.get_by_role("button", name="Sign in").click()
            expect(page.get_by_role("alert").get_by_text("This key is not valid.")).to_be_visible()
            assert serious_faults(page) == []
            field.fill(secret)
            page.get_by_role("button", name="Sign in").click()
            expect(page.get_by_role("heading", name="Gallery")).to_be_visible()
            assert secret not in page.url + page.evaluate("document.cookie + localStorage.length")
            page.reload()
            expect(page.get_by_role("heading", name="Gallery")).to_be_visible()
            page.get_by_role("button", name="Sign out").click()
            expect(field).to_be_visible()
