"""Annotations on the clip page: drawn, typed, corrected, accepted and taken back."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.live import Live, wait_until
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened


@pytest.fixture
def walk(workshop: Live) -> dict[str, Any]:
    with workshop.client() as client:
        query = {"person": "bruno", "task": "walk", "sort": "name"}
        found: dict[str, Any] = client.get("/v1/clips", params=query).json()["items"][0]
        client.put(f"/v1/clips/{found['id']}/annotations", json={"items": []})
    return found


def said(live: Live, clip_id: str) -> list[dict[str, Any]]:
    with live.client() as client:
        found: list[dict[str, Any]] = client.get(f"/v1/clips/{clip_id}/annotations").json()["items"]
    return found


def track(page: Page) -> Locator:
    return page.get_by_role("region", name="Annotations")


def bars(page: Page, kind: str) -> Locator:
    return track(page).get_by_role("button", name=re.compile(f"^{kind}: "))


def test_a_part_is_annotated_corrected_and_deleted_by_keys(
    browser: Browser, workshop: Live, walk: dict[str, Any]
) -> None:
    with opened(browser, workshop.url) as page:
        page.goto(f"/clips/{walk['id']}?t=1")
        expect(page.locator("[data-ready]")).to_be_visible()
        page.keyboard.press("a")
        expect(page.get_by_label("Words", exact=True)).to_be_focused()
        page.keyboard.type("stride left_leg")
        page.keyboard.press("Enter")
        bar = bars(page, "Annotation")
        expect(bar).to_have_attribute("aria-label", re.compile("stride, left leg, 1.00 to 2.00 s"))
        expect(bar).to_be_focused()
        expect(page).to_have_url(re.compile("at=annotation_"))

        page.keyboard.press("Enter")
        expect(page.get_by_label("Words", exact=True)).to_be_focused()
        page.keyboard.type("march")
        page.keyboard.press("Enter")
        expect(bar).to_have_attribute("aria-label", re.compile("march, 1.00 to 2.00 s"))
        page.get_by_label("End, s").fill("1.5")
        page.get_by_label("End, s").press("Enter")
        expect(bar).to_have_attribute("aria-label", re.compile("march, 1.00 to 1.50 s"))
        bar.focus()
        page.keyboard.press("Delete")
        expect(bar).to_have_count(0)
        for text in ("march, 1.00 to 1.50", "march, 1.00 to 2.00", "stride, left leg, 1.00 to 2"):
            page.keyboard.press("u")
            expect(bar).to_have_attribute("aria-label", re.compile(text))
        page.keyboard.press("u")
        expect(bar).to_have_count(0)
        wait_until(lambda: said(workshop, walk["id"]) == [], 60)


def test_a_part_is_drawn_and_resized_by_pointer(
    browser: Browser, workshop: Live, walk: dict[str, Any]
) -> None:
    with opened(browser, workshop.url) as page:
        page.goto(f"/clips/{walk['id']}")
        expect(page.locator("[data-ready]")).to_be_visible()
        lane = track(page).locator(".lanes")
        lane.scroll_into_view_if_needed()

        def drag(start: float, end: float) -> None:
            box = lane.bounding_box()
            assert box
            y = box["y"] + box["height"] / 2
            page.mouse.move(box["x"] + start * box["width"], y)
            page.mouse.down()
            page.mouse.move(box["x"] + end * box["width"], y, steps=4)
            page.mouse.up()

        drag(0.25, 0.5)
        page.get_by_label("Words", exact=True).fill("pace")
        page.get_by_role("button", name="Add", exact=True).click()
        expect(bars(page, "Annotation")).to_have_count(1)
        (drawn,) = said(workshop, walk["id"])
        assert drawn["start"] == pytest.approx(walk["duration"] / 4, abs=0.05)
        assert drawn["end"] == pytest.approx(walk["duration"] / 2, abs=0.05)
        drag(0.5, 0.75)
        wait_until(lambda: said(workshop, walk["id"])[0]["end"] != drawn["end"], 60)
        (resized,) = said(workshop, walk["id"])
        assert resized["end"] == pytest.approx(walk["duration"] * 3 / 4, abs=0.05)
        assert resized["start"] == drawn["start"]


def test_suggestions_are_accepted_by_a_key(
    browser: Browser, workshop: Live, walk: dict[str, Any]
) -> None:
    with opened(browser, workshop.url) as page:
        page.goto(f"/clips/{walk['id']}")
        expect(bars(page, "Suggestion")).not_to_have_count(0)
        count = bars(page, "Suggestion").count()
        page.keyboard.press("j")
        expect(bars(page, "Suggestion").first).to_be_focused()
        page.keyboard.press("y")
        expect(bars(page, "Annotation")).to_have_count(1)
        assert said(workshop, walk["id"])[0]["origin"] == "suggestion"
        page.keyboard.press("Control+z")
        expect(bars(page, "Annotation")).to_have_count(0)
        expect(bars(page, "Suggestion")).to_have_count(count)


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_the_lanes_have_no_serious_fault(
    browser: Browser,
    workshop: Live,
    walk: dict[str, Any],
    scheme: Scheme,
    size: tuple[int, int],
) -> None:
    with workshop.client() as client:
        body = {"start": 0.5, "end": 1.5, "words": ["step"]}
        added = client.post(f"/v1/clips/{walk['id']}/annotations", json=body).json()
    with opened(browser, workshop.url, size=size, scheme=scheme) as page:
        page.goto(f"/clips/{walk['id']}?at={added['id']}")
        expect(bars(page, "Annotation")).to_have_attribute("aria-pressed", "true")
        expect(bars(page, "Suggestion")).not_to_have_count(0)
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
