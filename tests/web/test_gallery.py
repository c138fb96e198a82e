"""The gallery: what is shown, chosen, labeled, deleted and handed in."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, Route, expect

from app.demo import demo_clips
from tests.live import NET_S, Live, serve, wait_until
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened

MANY = 10_000
SVG = '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 320 180"><path d="M0 90H320"/></svg>'


def cards(page: Page) -> Locator:
    return page.get_by_role("list", name="Clips").get_by_role("listitem")


def clips_of(live: Live) -> list[dict[str, Any]]:
    with live.client() as client:
        found: list[dict[str, Any]] = client.get("/v1/clips").json()["items"]
    return found


def names(page: Page) -> list[str]:
    return page.locator("[data-card] .name").all_text_contents()


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def test_filters_are_addresses(page: Page) -> None:
    page.goto("/")
    expect(cards(page)).to_have_count(12)
    expect(cards(page).locator("img")).to_have_count(12)
    page.get_by_role("button", name="Task").click()
    page.get_by_role("group", name="Task").get_by_label("kick").check()
    expect(cards(page)).to_have_count(4)
    page.get_by_role("searchbox", name="Part of the name").fill("01")
    expect(cards(page)).to_have_count(2)
    assert query_of(page) == {"task": ["kick"], "q": ["01"]}
    page.reload()
    expect(cards(page)).to_have_count(2)
    page.go_back()
    expect(cards(page)).to_have_count(12)
    page.go_forward()
    expect(cards(page)).to_have_count(2)
    page.get_by_role("button", name="Clear all").click()
    expect(cards(page)).to_have_count(12)


def test_measures_filter_and_sort(page: Page, demo_service: Live) -> None:
    speeds = {clip["name"]: clip["speed"] for clip in clips_of(demo_service)}
    page.goto("/?sort=-speed&size=l")
    expect(cards(page)).to_have_count(12)
    expect(page.get_by_role("status").first).to_have_text("12 clips")
    assert all("walk" in name for name in names(page)[:4])
    page.get_by_role("button", name="Measures").click()
    page.get_by_label("Speed, m/s, at least").fill("0.5")
    page.keyboard.press("Enter")
    expect(cards(page)).to_have_count(4)
    expect(page.get_by_role("status").first).to_have_text("4 clips")
    assert query_of(page)["speed_min"] == ["0.5"]
    assert all(speeds[name] >= 0.5 for name in names(page))
    page.reload()
    expect(cards(page)).to_have_count(4)
    expect(page.get_by_role("button", name="Measures 1")).to_be_visible()
    page.get_by_role("button", name="Clear all").click()
    expect(cards(page)).to_have_count(12)


def test_sources_and_licenses_are_menus_with_counts(browser: Browser, idle_service: Live) -> None:
    with idle_service.client() as client:
        for number, source in enumerate(("lab 3", "lab 3", "field")):
            files = {"file": ("a.bvh", f"HIERARCHY\nROOT of_{number}\n".encode())}
            labels = {"source": source, "license": "CC0-1.0", "name": f"from {source}"}
            client.post("/v1/clips", files=files, data=labels)
    with opened(browser, idle_service.url) as page:
        page.goto("/?q=from")
        expect(cards(page)).to_have_count(3)
        page.get_by_role("button", name="Source").click()
        page.get_by_role("group", name="Source").get_by_label(re.compile("lab 3")).check()
        expect(cards(page)).to_have_count(2)
        assert query_of(page)["source"] == ["lab 3"]
        page.get_by_role("button", name="License").click()
        group = page.get_by_role("group", name="License")
        expect(group.get_by_role("listitem").filter(has_text="CC0-1.0")).to_contain_text("3")


def test_order_and_size_are_addresses(page: Page) -> None:
    page.goto("/?sort=name&size=l")
    expect(cards(page)).to_have_count(12)
    assert names(page) == sorted(names(page))
    page.get_by_label("Order").select_option("-name")
    expect(page).to_have_url(re.compile("sort=-name"))
    expect(page.locator("[data-card] .name").first).to_have_text(re.compile("^walk|^wave"))
    page.get_by_role("button", name="Small").click()
    expect(page.locator("[data-card] .name")).to_have_count(0)


def test_a_range_is_chosen_with_shift_and_by_keyboard(page: Page) -> None:
    page.goto("/?sort=name")
    expect(cards(page)).to_have_count(12)
    boxes = page.get_by_role("checkbox", name=re.compile("^Choose "))
    boxes.nth(1).click(force=True)
    boxes.nth(4).click(force=True, modifiers=["Shift"])
    tray = page.get_by_role("region", name="Chosen clips")
    expect(tray.get_by_role("status")).to_have_text("4 clips chosen")
    chosen = query_of(page)["sel"]
    assert len(chosen) == 4
    page.reload()
    expect(tray.get_by_role("status")).to_have_text("4 clips chosen")
    page.locator("[data-card]").first.focus()
    for key in ("ArrowRight", "Shift+ArrowRight", "End", "x"):
        page.keyboard.press(key)
    expect(page.locator("[data-card]").last).to_be_focused()
    expect(tray.get_by_role("status")).to_have_text("5 clips chosen")
    page.get_by_role("button", name="Choose all").click()
    expect(tray.get_by_role("status")).to_have_text("12 clips chosen")
    tray.get_by_role("button", name="Choose none").click()
    expect(tray).to_be_hidden()


def test_only_the_clip_under_the_pointer_moves(browser: Browser, demo_service: Live) -> None:
    with opened(browser, demo_service.url) as page:
        page.emulate_media(reduced_motion="no-preference")
        page.goto("/")
        expect(cards(page)).to_have_count(12)
        for place in (0, 5):
            link = page.locator("[data-card]").nth(place)
            link.hover()
            canvas = page.locator("canvas[data-playing]")
            expect(canvas).to_have_attribute("data-playing", link.get_attribute("data-card") or "")
            expect(page.locator("canvas")).to_have_count(1)
            assert canvas.evaluate(
                "(c) => c.getContext('2d').getImageData(0, 0, c.width, c.height).data"
                ".some((value) => value > 0)"
            )
        page.mouse.move(0, 0)
        expect(page.locator("canvas")).to_have_count(0)


def test_ten_thousand_clips_are_scrolled_through(page: Page) -> None:
    page.goto("/")
    expect(cards(page)).to_have_count(12)
    one: dict[str, Any] = page.evaluate(
        "fetch('/v1/clips?limit=1').then((answer) => answer.json()).then(({items}) => items[0])"
    )

    def clips(route: Route) -> None:
        asked = parse_qs(urlsplit(route.request.url).query)
        first, limit = int(asked.get("cursor", ["0"])[0]), int(asked["limit"][0])
        last = min(first + limit, MANY)
        items = [one | {"id": f"clip_{n}", "name": f"take {n}"} for n in range(first, last)]
        page_of_clips = {"items": items, "next": str(last) if last < MANY else None}
        page_of_clips |= {"total": MANY, "total_is_exact": True}
        route.fulfill(content_type="application/json", body=json.dumps(page_of_clips))

    page.route(re.compile(r"/v1/clips\?"), clips)
    page.route(
        "**/thumbnail.svg", lambda route: route.fulfill(content_type="image/svg+xml", body=SVG)
    )
    page.goto("/?size=s")
    expect(page.get_by_role("status").first).to_have_text(f"{MANY:,} clips")
    page.wait_for_function(
        """(last) => {
            scrollTo(0, document.documentElement.scrollHeight);
            return document.querySelector(`[aria-label^="${last}"]`) !== null;
        }""",
        arg=f"take {MANY - 1},",
        polling=50,
    )
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight)")
    expect(page.get_by_label(f"take {MANY - 1},")).to_be_visible()
    assert cards(page).count() < 400
    page.evaluate("scrollTo(0, document.documentElement.scrollHeight / 2)")
    expect(page.get_by_label(f"take {MANY // 2},")).to_be_visible()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        page.goto("/?task=kick")
        expect(cards(page).locator("img")).to_have_count(4)
        page.get_by_role("button", name="Task 1").click()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


@pytest.fixture(scope="module")
def changed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A library that tests may change."""
    with serve(tmp_path_factory.mktemp("changed") / "data", worker=True) as live:
        yield live


def test_clips_are_handed_in_labeled_and_deleted(
    browser: Browser, changed: Live, tmp_path: Path
) -> None:
    folder = tmp_path / "takes"
    folder.mkdir()
    for clip in demo_clips(["ada"], ["kick"], takes=2):
        (folder / Path(clip.path).name).write_bytes(clip.content)
    (folder / "broken.bvh").write_text("HIERARCHY\nnothing")
    with opened(browser, changed.url) as page:
        page.goto("/")
        expect(page.get_by_text("This library is empty")).to_be_visible()
        page.get_by_label("Folder to add").set_input_files(folder)
        uploads = page.get_by_role("region", name="Uploads")
        expect(uploads.get_by_role("status")).to_have_text(
            "Done · 1 failed · 2 ready", timeout=60_000
        )
        broken = uploads.get_by_role("listitem").filter(has_text="broken.bvh")
        expect(broken).to_contain_text("line 2")
        expect(cards(page)).to_have_count(3)

        page.get_by_role("button", name="Choose all").click()
        tray = page.get_by_role("region", name="Chosen clips")
        tray.get_by_role("button", name="Label").click()
        page.get_by_label("Task", exact=True).fill("high kick")
        page.get_by_label("Words to add").fill("kick left_leg")
        page.get_by_role("button", name="Label 3 clips").click()
        expect(page.get_by_text("3 clips labeled.")).to_be_visible()
        expect(page.locator(".facts", has_text="high kick")).to_have_count(3)
        page.get_by_role("button", name="Undo").click()
        expect(page.locator(".facts", has_text="high kick")).to_have_count(0)

        tray.get_by_role("button", name="Choose none").click()
        page.get_by_role("checkbox", name=re.compile("Choose kick_01")).click(force=True)
        tray.get_by_role("button", name="Collect", exact=True).click()
        page.get_by_label("New collection").fill("best")
        page.keyboard.press("Enter")
        expect(page.get_by_text("1 motion added to “best”.")).to_be_visible()
        page.reload()
        page.get_by_role("button", name="Collection", exact=True).click()
        page.get_by_role("group", name="Collection").get_by_label("best").check()
        expect(cards(page)).to_have_count(1)
        assert query_of(page)["collection"][0].startswith("collection_")
        page.get_by_role("button", name="Clear all").click()
        expect(cards(page)).to_have_count(3)
        page.get_by_role("button", name="Choose all").click()
        expect(tray.get_by_role("status")).to_have_text("3 clips chosen")

        tray.get_by_role("button", name="Delete").click()
        expect(cards(page)).to_have_count(0)
        deleted = page.locator(".notice").filter(has_text="3 clips deleted.")
        deleted.get_by_role("button", name="Undo").click()
        expect(cards(page)).to_have_count(3)
        page.get_by_role("checkbox", name=re.compile("Choose broken")).click(force=True)
        tray.get_by_role("button", name="Delete").click()
        expect(cards(page)).to_have_count(2)
        page.get_by_role("button", name="Dismiss").last.click()
        wait_until(lambda: len(clips_of(changed)) == 2, NET_S)
        page.reload()
        expect(cards(page)).to_have_count(2)
