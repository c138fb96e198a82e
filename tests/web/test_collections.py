"""Collections: hits are set aside and collected; an edit of a clip, and its measures."""

from __future__ import annotations

import re

from playwright.sync_api import Browser, expect

from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import opened


def test_hits_are_set_aside_collected_and_put_in_order(browser: Browser, workshop: Live) -> None:
    with opened(browser, workshop.url) as page:
        page.goto("/search?q=wave")
        hits = page.get_by_role("list", name="Hits").get_by_role("listitem")
        for place in (0, 1):
            hits.nth(place).get_by_role("button", name=re.compile("^What is like")).click()
            hits.nth(place).get_by_role("button", name="Set aside to collect").click()
        tray = page.get_by_role("region", name="Set aside")
        expect(tray).to_contain_text("2 hits set aside")
        tray.get_by_role("button", name="Collect").click()
        page.get_by_label("New collection").fill("Greetings")
        page.keyboard.press("Enter")
        page.get_by_role("button", name="Open").click()
        expect(page.get_by_role("heading", name="Greetings")).to_be_visible()
        items = page.get_by_role("list", name="Items").get_by_role("listitem")
        expect(items).to_have_count(2)
        expect(page.get_by_role("region", name="What it covers")).to_contain_text("2 clips")
        assert serious_faults(page) == []
        with page.expect_response(lambda answer: answer.url.endswith("/order")):
            items.first.get_by_role("button", name=re.compile("one place down$")).press("Enter")
        page.get_by_role("button", name="Download").click()
        with page.expect_download() as file:
            page.get_by_role("link", name="Download the ZIP").click()
        assert file.value.suggested_filename.endswith(".zip")


def test_an_edit_makes_a_clip_that_links_to_its_origin(browser: Browser, workshop: Live) -> None:
    with workshop.client() as client:
        query = {"person": "bruno", "task": "wave", "sort": "-name", "fields": "id"}
        clip_id = client.get("/v1/clips", params=query).json()["items"][0]["id"]
    with opened(browser, workshop.url) as page:
        page.goto(f"/clips/{clip_id}?from=0.5&to=2")
        expect(page.get_by_role("region", name="Measures")).to_contain_text("Foot skate")
        page.get_by_role("button", name=re.compile("^Foot skate")).press("Enter")
        expect(page.get_by_text("Horizontal speed of an ankle")).to_be_visible()
        assert serious_faults(page) == []
        page.get_by_role("button", name="Edit").click()
        page.get_by_label("Mirror left and right").check()
        page.get_by_role("button", name="Make the clip").click()
        expect(page).not_to_have_url(re.compile(clip_id))
        origin = page.get_by_role("link", name="the original")
        expect(origin).to_have_attribute("href", f"/clips/{clip_id}")
        expect(page.locator("dd", has=origin)).to_contain_text("cut, mirror")
