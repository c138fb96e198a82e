"""The search page: words, a motion as the query, what is found, and its addresses."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any, Literal
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import demo_clips
from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened

STORED = 12


@pytest.fixture
def kick(demo_service: Live) -> dict[str, Any]:
    with demo_service.client() as client:
        found: dict[str, Any] = client.get(
            "/v1/clips", params={"person": "ada", "task": "kick"}
        ).json()["items"][0]
    return found


def hits(page: Page) -> Locator:
    return page.get_by_role("list", name="Hits").get_by_role("listitem")


def box(page: Page) -> Locator:
    return page.get_by_role("combobox", name="Words to search for")


def ask_for(hit: Locator, role: Literal["button", "link"], name: str) -> None:
    """Choose in a hit's menu."""
    hit.get_by_role("button", name=re.compile("^What is like")).click()
    hit.get_by_role(role, name=name).click()


def play(hit: Locator) -> None:
    hit.get_by_role("button", name=re.compile("^Play")).click()


def chips(page: Page) -> Locator:
    """The motions among the parts of the query."""
    search = page.get_by_role("search", name="Motions")
    return search.get_by_role("group").filter(has=page.locator(".picture"))


def player(page: Page) -> Locator:
    return page.get_by_role("region", name=re.compile("^Player of"))


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def test_words_are_completed_asked_for_and_left_out(page: Page) -> None:
    page.goto("/search")
    expect(page.get_by_role("heading", name="What do you look for?")).to_be_visible()
    box(page).fill("wav")
    expect(page.get_by_role("option", name=re.compile("^wave"))).to_be_visible()
    page.keyboard.press("ArrowDown")
    page.keyboard.press("Enter")
    expect(page.get_by_role("group", name="wave", exact=True)).to_be_visible()
    expect(hits(page).first).to_contain_text("wave")
    expect(page.get_by_role("status").filter(has_text=" ms")).to_be_visible()
    assert query_of(page) == {"q": ["wave"]}
    box(page).fill("-kick")
    page.keyboard.press("Enter")
    expect(page).to_have_url(re.compile("q=wave&q=-kick"))
    page.get_by_role("button", name=re.compile("^With wave")).click()
    expect(page).to_have_url(re.compile("q=-wave&q=-kick"))
    expect(hits(page).first).to_contain_text("walk")
    page.reload()
    expect(page.get_by_role("button", name=re.compile("^Without wave"))).to_be_visible()
    page.get_by_role("button", name="Remove wave").click()
    page.keyboard.press("Backspace")
    expect(page.get_by_role("heading", name="What do you look for?")).to_be_visible()


def test_back_and_forward_keep_what_was_asked(page: Page) -> None:
    page.goto("/search?q=wave")
    expect(hits(page).first).to_contain_text("wave")
    page.get_by_role("button", name="Person").click()
    page.get_by_role("group", name="Person").get_by_label("ada").check()
    expect(page).to_have_url(re.compile("person=ada"))
    expect(hits(page).filter(has_text="ada")).not_to_have_count(0)
    expect(hits(page).filter(has_not_text="ada")).to_have_count(0)
    page.keyboard.press("Escape")
    ask_for(hits(page).first, "link", "Only like this")
    expect(page.get_by_role("region", name="The motion that is searched with")).to_be_visible()
    assert query_of(page).keys() == {"clip"}
    page.go_back()
    expect(page.get_by_role("group", name="wave", exact=True)).to_be_visible()
    expect(hits(page).filter(has_not_text="ada")).to_have_count(0)
    page.go_back()
    expect(page).not_to_have_url(re.compile("person="))
    expect(hits(page).filter(has_not_text="ada")).not_to_have_count(0)
    page.go_forward()
    expect(hits(page).filter(has_not_text="ada")).to_have_count(0)


def test_more_like_a_clip_plays_in_step_with_it(page: Page, kick: dict[str, Any]) -> None:
    page.goto(f"/clips/{kick['id']}")
    page.get_by_role("link", name="More like this").click()
    expect(hits(page)).to_have_count(STORED - 1)
    expect(hits(page).first).to_contain_text("kick")
    play(hits(page).first)
    expect(player(page)).to_have_attribute("data-ready", "")
    expect(player(page).locator(".head")).to_have_count(2)
    expect(player(page).locator(".head").first).to_have_text(kick["name"])
    page.get_by_label("Method").select_option("dtw")
    expect(page.get_by_role("status").filter(has_text="dtw")).to_be_visible()
    page.reload()
    expect(player(page).locator(".head")).to_have_count(2)
    assert query_of(page).keys() == {"clip", "hit", "method"}


def test_parts_of_clips_are_found_with_their_times(page: Page, kick: dict[str, Any]) -> None:
    page.goto(f"/search?clip={kick['id']}&method=metric-task")
    expect(hits(page)).to_have_count(STORED - 1)
    page.get_by_label("From second").fill("0.5")
    page.get_by_label("From second").press("Enter")
    page.get_by_label("To second").fill("2")
    page.get_by_label("To second").press("Enter")
    page.get_by_label("What is found").select_option("windows")
    expect(hits(page).first).to_contain_text(re.compile(r"\d\.\d\d – \d+\.\d\d s"))
    assert query_of(page) == {
        "clip": [kick["id"]],
        "start": ["0.5"],
        "end": ["2"],
        "scope": ["windows"],
    }
    play(hits(page).first)
    expect(player(page).locator(".head")).to_have_count(2)
    expect(page).to_have_url(re.compile("hit="))


def test_a_part_is_shown_where_it_lies_and_searched_with(page: Page, kick: dict[str, Any]) -> None:
    page.goto(f"/clips/{kick['id']}?from=0.5&to=2")
    page.get_by_role("link", name="More like this part").click()
    expect(hits(page).first.locator(".line")).to_be_visible()
    assert query_of(page) == {
        "clip": [kick["id"]],
        "start": ["0.5"],
        "end": ["2"],
        "scope": ["windows"],
    }


def test_a_pose_is_found_in_other_clips(page: Page, kick: dict[str, Any]) -> None:
    page.goto(f"/clips/{kick['id']}?t=1.5")
    page.get_by_role("link", name="Find this pose").click()
    expect(hits(page).first).to_contain_text(re.compile(r"at \d+\.\d\d s"))
    expect(page.get_by_text("A pose of")).to_be_visible()
    play(hits(page).first)
    expect(player(page).locator(".head")).to_have_count(2)
    expect(page).to_have_url(re.compile(r"[?&]t="))
    page.reload()
    expect(player(page).locator(".head")).to_have_count(2)
    page.get_by_label("At second").fill("0.5")
    page.get_by_label("At second").press("Enter")
    expect(page).to_have_url(re.compile(r"pose=0\.5"))
    expect(hits(page).first).to_be_visible()


def test_a_file_is_searched_with_and_asked_for_again(page: Page, tmp_path: Path) -> None:
    clip = next(demo_clips(("ada",), ("kick",), takes=1))
    path = tmp_path / "query.bvh"
    path.write_bytes(clip.content)
    page.goto("/search?q=wave")
    page.get_by_label("File to search with").first.set_input_files(path)
    expect(page.get_by_role("group", name="query.bvh")).to_be_visible()
    expect(page.get_by_role("button", name="What each part says")).to_be_visible()
    expect(hits(page).first).to_contain_text("wave")
    page.get_by_role("button", name="Remove wave").click()
    expect(page.get_by_text("It is not stored")).to_be_visible()
    expect(hits(page).first).to_contain_text("kick")
    page.go_back()
    expect(page.get_by_role("group", name="wave", exact=True)).to_be_visible()
    page.go_forward()
    expect(hits(page).first).to_contain_text("kick")
    page.reload()
    expect(page.get_by_role("button", name="Choose the file again")).to_be_visible()


def test_hits_become_parts_that_are_for_and_against(page: Page) -> None:
    page.goto("/search?q=wave")
    name = hits(page).first.locator(".name").inner_text()
    ask_for(hits(page).first, "button", "More like this")
    expect(chips(page)).to_have_count(1)
    expect(page.get_by_role("group", name=name, exact=True)).to_be_visible()
    assert query_of(page).keys() == {"q", "clip"}
    expect(hits(page)).to_have_count(STORED - 1)
    ask_for(hits(page).nth(1), "button", "Less like this")
    expect(chips(page)).to_have_count(2)
    expect(page).to_have_url(re.compile(r"ex=clip_\w+&ex=-clip_\w+"))
    expect(
        page.get_by_role("status").filter(has_text=re.compile(r"Fused · \d+ ms"))
    ).to_be_visible()
    page.get_by_role("button", name="What each part says").click()
    said = hits(page).first.get_by_role("list", name="What each part says").get_by_role("listitem")
    expect(said).to_have_count(3)
    expect(said.nth(0)).to_have_text(re.compile(rf"{re.escape(name)}\s+[01]\.\d\d"))
    expect(said.nth(1)).to_contain_text("Against:")
    expect(said.nth(2)).to_have_text(re.compile(r"wave\s+[01]\.\d\d"))
    page.reload()
    expect(said).to_have_count(3)
    expect(chips(page)).to_have_count(2)
    play(hits(page).first)
    expect(player(page).locator(".head")).to_have_count(2)


def test_parts_change_their_sign_and_go_by_keyboard(page: Page, kick: dict[str, Any]) -> None:
    page.goto(f"/search?clip={kick['id']}&start=0.5&end=2&q=wave")
    expect(chips(page)).to_contain_text("0.5–2 s")
    expect(hits(page).first).to_be_visible()
    page.get_by_role("button", name=re.compile("^More like")).press("Enter")
    expect(page.get_by_role("button", name=re.compile("^Less like"))).to_be_visible()
    assert query_of(page) == {"q": ["wave"], "ex": [f"-{kick['id']}@0.5-2"]}
    expect(hits(page).first).to_contain_text("wave")
    page.get_by_role("button", name="Remove wave").press("Enter")
    expect(page.get_by_role("alert").filter(has_text="against something")).to_be_visible()
    expect(hits(page)).to_have_count(0)
    page.get_by_role("button", name=re.compile("^Less like")).press("Enter")
    expect(page.get_by_role("region", name="The motion that is searched with")).to_be_visible()
    expect(page.get_by_label("From second")).to_have_value("0.5")
    assert query_of(page) == {"clip": [kick["id"]], "start": ["0.5"], "end": ["2"]}
    page.go_back()
    page.get_by_role("button", name=f"Remove {kick['name']}").press("Enter")
    expect(page.get_by_role("heading", name="What do you look for?")).to_be_visible()


def test_what_cannot_be_searched_is_said(browser: Browser, demo_service: Live) -> None:
    with opened(browser, demo_service.url, expected=("404",)) as page:
        page.goto("/search?clip=nope")
        expect(page.get_by_role("alert").filter(has_text="nope")).to_be_visible()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser,
    demo_service: Live,
    kick: dict[str, Any],
    scheme: Scheme,
    size: tuple[int, int],
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        parts = f"/search?ex={kick['id']}&ex=-{kick['id']}@0.5-1&q=wave&q=-bow&why=1"
        for address in ("/search", "/search?q=wave&q=-kick", f"/search?clip={kick['id']}", parts):
            page.goto(address)
            shown = hits(page).first if "?" in address else page.get_by_text("What do you")
            expect(shown).to_be_visible()
            if "?" in address:
                box(page).fill("wa")
                expect(page.get_by_role("option").first).to_be_visible()
            assert serious_faults(page) == []
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_a_faster_motion_is_the_same_unless_the_tempo_counts(
    page: Page, kick: dict[str, Any]
) -> None:
    page.goto(f"/search?clip={kick['id']}")
    expect(hits(page)).to_have_count(STORED - 1)
    with page.expect_response("**/v1/search/motion") as answer:
        page.get_by_role("button", name="Same tempo").click()
    assert answer.value.status == 200
    assert query_of(page)["paced"] == ["1"]
    page.reload()
    expect(page.get_by_role("button", name="Same tempo")).to_have_attribute("aria-pressed", "true")
    page.get_by_label("Method").select_option("dtw")
    expect(page.get_by_role("button", name="Same tempo")).to_be_hidden()
