"""To do: near-duplicates and outliers, side by side, settled by keys and taken back."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import demo_clips
from tests.live import Live, wait_until
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened


@pytest.fixture(scope="module")
def messy(workshop: Live) -> Live:
    """The library with a mirrored walk, a cut wave, and a kick that is called a walk.

    Two walks more, since a task of few clips has no outliers.
    """
    for walk in demo_clips(("chika",), ("walk",), takes=2):
        workshop.wait_for_job(workshop.upload(walk).json()["job"]["id"])
    with workshop.client() as client:

        def clip(person: str, task: str) -> str:
            query = {"person": person, "task": task, "sort": "name", "fields": "id"}
            return str(client.get("/v1/clips", params=query).json()["items"][0]["id"])

        edits: list[tuple[str, dict[str, Any]]] = [
            (clip("ada", "walk"), {"kind": "mirror"}),
            (clip("bruno", "wave"), {"kind": "cut", "start": 0.2, "end": 2.5}),
        ]
        for clip_id, step in edits:
            made = client.post(f"/v1/clips/{clip_id}/edits", json={"steps": [step]}).json()
            workshop.wait_for_job(made["job"]["id"])
        client.patch(f"/v1/clips/{clip('ada', 'kick')}", json={"task": "walk"})

        def compared() -> bool:
            found = client.get("/v1/duplicates").json()
            return found["pending"] == 0 and found["total"] >= len(edits)

        wait_until(compared, 300)
        wait_until(lambda: client.get("/v1/outliers").json()["items"], 300)
    return workshop


def queue(page: Page) -> Locator:
    return page.get_by_role("list", name="Queue").get_by_role("listitem")


def test_duplicates_are_kept_dropped_and_told_apart_by_keys(browser: Browser, messy: Live) -> None:
    with messy.client() as client:
        before = client.get("/v1/clips?limit=1").json()["total"]
        groups = client.get("/v1/duplicates").json()["total"]
    with opened(browser, messy.url) as page:
        page.goto("/todo?kind=duplicates")
        expect(queue(page)).to_have_count(groups)
        clips = page.get_by_role("list", name="Clips of the group").get_by_role("listitem")
        expect(clips).to_have_count(2)
        expect(clips.nth(0)).to_contain_text("Keep")
        expect(clips.nth(1)).to_contain_text("Drop")
        page.keyboard.press("2")
        expect(clips.nth(1)).to_contain_text("Keep")
        expect(page.get_by_role("button", name="Keep 2, drop 0")).to_be_disabled()
        page.keyboard.press("2")
        page.keyboard.press("a")
        expect(queue(page)).to_have_count(groups - 1)
        expect(page.get_by_text(f"1 of {groups} groups done")).to_be_visible()
        page.get_by_role("button", name="Undo").click()
        expect(queue(page)).to_have_count(groups)
        page.keyboard.press("a")
        expect(queue(page)).to_have_count(groups - 1)
        page.get_by_role("button", name="Dismiss").first.click()
        wait_until(lambda: _total(messy) == before - 1, 60)
        page.keyboard.press("x")
        expect(page.get_by_text("No duplicates here")).to_be_visible()
        page.get_by_role("button", name="Dismiss").last.click()
        wait_until(lambda: _groups(messy) == 0, 60)


def _total(live: Live) -> int:
    with live.client() as client:
        return int(client.get("/v1/clips?limit=1").json()["total"])


def _groups(live: Live) -> int:
    with live.client() as client:
        return int(client.get("/v1/duplicates").json()["total"])


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
@pytest.mark.parametrize("kind", ["duplicates", "outliers"])
def test_the_queues_have_no_serious_fault(
    browser: Browser, messy: Live, scheme: Scheme, size: tuple[int, int], kind: str
) -> None:
    with opened(browser, messy.url, size=size, scheme=scheme) as page:
        page.goto(f"/todo?kind={kind}&threshold=0.5")
        expect(queue(page)).not_to_have_count(0)
        expect(page.locator("[data-ready]")).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_wrong_label_is_corrected_by_a_key_and_that_is_taken_back(
    browser: Browser, messy: Live
) -> None:
    with messy.client() as client:
        found = client.get("/v1/outliers?limit=100").json()["items"]
    (wrong,) = [one for one in found if one["suggested"] == "kick"]
    clip = wrong["clip"]

    def task() -> str:
        with messy.client() as client:
            return str(client.get(f"/v1/clips/{clip['id']}").json()["task"])

    with opened(browser, messy.url) as page:
        page.goto(f"/todo?kind=outliers&at={clip['id']}.far")
        expect(page.get_by_role("heading", name=clip["name"])).to_be_visible()
        expect(page.get_by_text("Beside", exact=False).first).to_be_visible()
        expect(page.locator("[data-ready] .head")).to_have_count(2)
        page.keyboard.press("v")
        expect(page.get_by_role("button", name=re.compile("^Beside kick"))).to_have_attribute(
            "aria-pressed", "true"
        )
        page.keyboard.press("a")
        expect(page.get_by_text(f"{clip['name']} is now kick.")).to_be_visible()
        assert task() == "kick"
        page.get_by_role("button", name="Undo").click()
        wait_until(lambda: task() == "walk", 60)
        page.keyboard.press("r")
        page.get_by_label("Task", exact=True).fill("kick")
        page.keyboard.press("Enter")
        wait_until(lambda: task() == "kick", 60)
