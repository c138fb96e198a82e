"""The search page: why a clip is a hit."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import demo_clips
from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened


@pytest.fixture(scope="module")
def kicks(demo_service: Live) -> list[dict[str, Any]]:
    """A kick of each person."""
    with demo_service.client() as client:
        return [
            client.get("/v1/clips", params={"person": person, "task": "kick"}).json()["items"][0]
            for person in ("ada", "bruno")
        ]


def panel(page: Page) -> Locator:
    return page.get_by_role("dialog", name=re.compile("^Why .+ is a hit$"))


def player(page: Page) -> Locator:
    return panel(page).get_by_role("region", name=re.compile("^Player of the hit"))


def parts(page: Page) -> Locator:
    region = panel(page).get_by_role("region", name="What each part adds to the distance")
    return region.get_by_role("button")


def test_a_hit_plays_in_step_with_its_example_and_shows_which_joints_differ(
    page: Page, kicks: list[dict[str, Any]]
) -> None:
    page.goto(f"/search?clip={kicks[0]['id']}&q=kick")
    hit = page.get_by_role("list", name="Hits").get_by_role("listitem").first
    menu = hit.get_by_role("button", name=re.compile("^What is like"))
    menu.click()
    with page.expect_response("**/v1/search/why") as answer:
        hit.get_by_role("button", name="Why it is a hit").click()
    found = answer.value.json()
    expect(panel(page).get_by_role("status")).to_contain_text(f"score {found['score']:.2f}")
    expect(player(page)).to_have_attribute("data-ready", "")
    expect(player(page).locator(".head")).to_have_text(
        [re.compile(f"^Example · {kicks[0]['name']}"), re.compile("^Hit ·")]
    )
    expect(parts(page)).to_have_count(2)
    expect(parts(page).first).to_contain_text(f"{found['parts'][0]['cost']:.2f}")
    joints = panel(page).get_by_role("region", name="Joints by difference").get_by_role("button")
    expect(joints).to_have_count(12)
    means = found["parts"][0]["alignment"]["mean_differences"]
    expect(joints.first).to_contain_text(re.compile(rf"{max(means) * 100:.0f}|\.\d cm"))
    before = player(page).locator("canvas").screenshot()
    joints.last.click()
    expect(joints.last).to_have_attribute("aria-pressed", "true")
    peaks = panel(page).get_by_role("region", name="Where they differ most")
    peaks.get_by_role("button").first.click()
    expect(joints.last).to_have_attribute("aria-pressed", "false")
    expect(player(page).get_by_role("slider", name="Time")).not_to_have_attribute(
        "aria-valuenow", "0"
    )
    assert player(page).locator("canvas").screenshot() != before
    page.keyboard.press("Escape")
    expect(panel(page)).to_be_hidden()
    expect(menu).to_be_focused()
    expect(page).not_to_have_url(re.compile("about="))
    page.keyboard.press("w")
    expect(player(page)).to_have_attribute("data-ready", "")
    page.go_back()
    expect(panel(page)).to_be_hidden()


def test_words_and_poses_say_when_they_fit(page: Page, kicks: list[dict[str, Any]]) -> None:
    own, other = (kick["id"] for kick in kicks)
    page.goto(f"/search?clip={own}&q=kick&about={other}")
    parts(page).nth(1).click()
    expect(panel(page).get_by_role("img", name="Words: probability over seconds")).to_be_visible()
    moment = panel(page).get_by_role("button", name=re.compile("kick is most probable"))
    moment.click()
    seconds = re.match(r"[\d.]+", moment.inner_text())
    assert seconds
    expect(player(page).get_by_role("slider", name="Time")).to_have_attribute(
        "aria-valuetext", re.compile(f"^{re.escape(seconds[0])}")
    )
    page.goto(f"/search?clip={own}&pose=1&about={other}")
    expect(panel(page).get_by_role("button", name=re.compile("nearest to pose 1"))).to_be_visible()


def test_a_file_is_compared_though_it_cannot_play(page: Page, tmp_path: Path) -> None:
    clip = next(demo_clips(("ada",), ("kick",), takes=1))
    path = tmp_path / "query.bvh"
    path.write_bytes(clip.content)
    page.goto("/search")
    page.get_by_label("File to search with").first.set_input_files(path)
    page.get_by_role("button", name=re.compile("^Play")).first.press("w")
    expect(panel(page).get_by_text("The file is not stored")).to_be_visible()
    expect(parts(page)).to_contain_text(["query.bvh"])
    expect(player(page)).to_have_attribute("data-ready", "")


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser,
    demo_service: Live,
    kicks: list[dict[str, Any]],
    scheme: Scheme,
    size: tuple[int, int],
) -> None:
    own, other = (kick["id"] for kick in kicks)
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        page.goto(f"/search?ex={own}&ex=-{own}@0.5-1&q=kick&about={other}")
        expect(player(page)).to_have_attribute("data-ready", "")
        for place in (0, 2):
            parts(page).nth(place).click()
            assert serious_faults(page) == []
        assert panel(page).evaluate("(panel) => panel.scrollWidth <= panel.clientWidth")
