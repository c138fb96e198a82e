"""The clip page and its player."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any, Protocol
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, Route, expect

from tests.live import NET_S, Live, wait_until
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of


class OpenClip(Protocol):
    """Opens the page of a kick, and waits for its player; gives the clip."""

    def __call__(self, page: Page, query: str = "") -> dict[str, Any]: ...


@pytest.fixture
def open_clip(demo_service: Live) -> OpenClip:
    with demo_service.client() as client:
        clip: dict[str, Any] = client.get(
            "/v1/clips", params={"person": "ada", "task": "kick"}
        ).json()["items"][0]

    def opens(page: Page, query: str = "") -> dict[str, Any]:
        page.goto(f"/clips/{clip['id']}{query}")
        expect(player(page)).to_have_attribute("data-ready", "")
        return clip

    return opens


def player(page: Page) -> Locator:
    return page.get_by_role("region", name=re.compile("^Player of"))


def lit(page: Page) -> int:
    """How many colors the player's picture has: one is an empty canvas."""
    return colors_of(player(page).locator("canvas"))


def seconds(page: Page) -> float:
    return float(
        player(page).get_by_role("slider", name="Time").get_attribute("aria-valuenow") or 0
    )


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def picture(page: Page) -> bytes:
    return player(page).locator("canvas").screenshot()


def wait_for_picture(page: Page, wanted: Callable[[bytes], bool]) -> bytes:
    """The player's picture when it is as `wanted`: it is drawn with the browser's next frame."""
    found: list[bytes] = []

    def is_seen() -> bool:
        found.append(picture(page))
        return wanted(found[-1])

    wait_until(is_seen, NET_S)
    return found[-1]


def test_a_body_is_drawn_and_its_bones_are(page: Page, open_clip: OpenClip) -> None:
    open_clip(page)
    assert lit(page) > 100
    skin = picture(page)
    page.keyboard.press("b")
    expect(page).to_have_url(re.compile("body=bones"))
    expect(page.get_by_role("button", name="Body")).to_have_attribute("aria-pressed", "false")
    wait_for_picture(page, lambda now: now != skin)
    assert lit(page) > 100
    page.get_by_role("button", name="Body").click()
    expect(page).not_to_have_url(re.compile("body="))
    wait_for_picture(page, lambda now: now == skin)


def test_a_body_without_known_roles_is_bones(page: Page, open_clip: OpenClip) -> None:
    """So are the skeletons of animals, whose roles a client named."""
    change_clip(page, roles={"hips": "Hips"})
    open_clip(page)
    assert lit(page) > 100
    expect(page.get_by_role("button", name="Mirror")).to_be_visible()
    expect(page.get_by_role("button", name="Body")).to_have_count(0)
    expect(page.get_by_role("button", name="First person")).to_have_count(0)


def test_the_view_of_the_first_person_is_taken_and_left(page: Page, open_clip: OpenClip) -> None:
    open_clip(page, "?t=1")
    first = picture(page)
    page.keyboard.press("e")
    expect(page).to_have_url(re.compile("eyes=1"))
    seen = wait_for_picture(page, lambda now: now != first)
    page.reload()
    expect(player(page)).to_have_attribute("data-ready", "")
    wait_for_picture(page, lambda now: now == seen)
    page.get_by_role("button", name="Reset the camera").click()
    expect(page).not_to_have_url(re.compile("eyes="))
    wait_for_picture(page, lambda now: now == first)


def test_a_reset_brings_the_first_view_back(page: Page, open_clip: OpenClip) -> None:
    open_clip(page, "?cam=-120,60,2.5,0.4,0.2,0&follow=0")
    turned = picture(page)
    assert lit(page) > 100
    page.get_by_role("button", name="Reset the camera").click()
    wait_for_picture(page, lambda now: now != turned)
    assert query_of(page) == {}


def change_clip(page: Page, **fields: object) -> None:
    """Answers about single clips have other fields, as those of other files have."""

    def answer(route: Route) -> None:
        response = route.fetch()
        route.fulfill(response=response, json=response.json() | fields)

    page.route(re.compile(r"/v1/clips/clip_\w+$"), answer)


WARNINGS = [
    {"code": "unit_guessed", "detail": "It may be in cm.", "likely": 0.01},
    {
        "code": "bone_length_jumps",
        "detail": "The forearm has 0.9 m.",
        "likely": None,
        "start": 1.2,
        "end": 1.4,
        "joint": "LeftHand",
    },
]


def test_a_warning_leads_to_its_place(page: Page, open_clip: OpenClip) -> None:
    change_clip(page, warnings=WARNINGS)
    open_clip(page)
    recording = page.get_by_role("region", name="The recording")
    expect(recording.get_by_role("listitem")).to_have_count(2)
    expect(player(page).locator("svg text")).to_have_text("bone length jumps: LeftHand")
    recording.get_by_role("button", name="Show 1.20 – 1.40 s, LeftHand").click()
    expect(page).to_have_url(re.compile("t=1.2&joint=LeftHand"))
    time = player(page).get_by_role("slider", name="Time")
    expect(time).to_have_attribute("aria-valuenow", "1.2")
    expect(player(page).locator(".marked")).to_have_text("LeftHand")
    expect(player(page).locator(".marked")).to_be_in_viewport()
    page.keyboard.press("Escape")
    expect(player(page).locator(".marked")).to_have_count(0)
    page.go_back()
    expect(page).to_have_url(re.compile(r"/clips/clip_\w+$"))
    expect(time).to_have_attribute("aria-valuenow", "0")


def test_it_plays_and_stops_and_the_time_is_an_address(page: Page, open_clip: OpenClip) -> None:
    frame = 1 / open_clip(page)["frame_rate"]
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Stop")).to_be_visible()
    page.wait_for_function("() => document.querySelector('[role=slider]').ariaValueNow > 0.2")
    page.keyboard.press("Space")
    expect(page).to_have_url(re.compile(r"[?&]t="))
    stopped = seconds(page)
    page.keyboard.press(".")
    assert seconds(page) == pytest.approx(stopped + frame, abs=1e-6)
    page.keyboard.press(",")
    page.keyboard.press("ArrowRight")
    assert seconds(page) == pytest.approx(stopped + 0.1, abs=1e-6)
    expect(page).to_have_url(re.compile(rf"t={re.escape(f'{stopped + 0.1:.3f}'.rstrip('0'))}\d*"))
    page.reload()
    expect(player(page)).to_have_attribute("data-ready", "")
    assert seconds(page) == pytest.approx(stopped + 0.1, abs=0.002)


def test_keys_set_the_range_and_what_is_shown(page: Page, open_clip: OpenClip) -> None:
    open_clip(page, "?t=1")
    page.keyboard.press("i")
    for _ in range(5):
        page.keyboard.press("ArrowRight")
    page.keyboard.press("o")
    for key in ("m", "g", "t", "p", "n", "l", "-"):
        page.keyboard.press(key)
    expect(page.get_by_role("button", name="Mirror")).to_have_attribute("aria-pressed", "true")
    expect(page.get_by_role("combobox", name="Speed")).to_have_value("0.5")
    expect(page).to_have_url(re.compile("speed=0.5"))
    said = query_of(page)
    assert (float(said["from"][0]), float(said["to"][0])) == pytest.approx((1, 1.5))
    assert {said[name][0] for name in ("mirror", "ghosts", "trails", "place", "names")} == {"1"}
    assert said["loop"] == ["0"]
    page.keyboard.press("Space")
    expect(page.get_by_role("button", name="Play", exact=True)).to_be_visible()
    expect(page).to_have_url(re.compile(r"t=1\.5"))
    page.keyboard.press("?")
    expect(page.get_by_role("dialog")).to_contain_text("In place")
    page.keyboard.press("Escape")
    expect(page.get_by_role("dialog")).to_be_hidden()
    page.keyboard.press("Escape")
    expect(page).not_to_have_url(re.compile("from="))


def test_the_camera_is_an_address(page: Page, open_clip: OpenClip) -> None:
    open_clip(page)
    box = player(page).locator("canvas").bounding_box()
    assert box
    page.mouse.move(box["x"] + 200, box["y"] + 200)
    page.mouse.down()
    page.mouse.move(box["x"] + 320, box["y"] + 180, steps=4)
    page.mouse.up()
    expect(page).to_have_url(re.compile("cam="))
    moved = query_of(page)["cam"]
    page.reload()
    expect(player(page)).to_have_attribute("data-ready", "")
    assert query_of(page)["cam"] == moved
    page.keyboard.press("c")
    expect(page).not_to_have_url(re.compile("cam="))


def test_similar_clips_and_few_dimensions_play_beside_it(page: Page, open_clip: OpenClip) -> None:
    open_clip(page)
    beside = page.get_by_role("button", name=re.compile("beside this one$"))
    expect(beside).to_have_count(6)
    beside.first.click()
    page.get_by_label("Play it from few dimensions").check()
    expect(player(page).locator(".head")).to_have_count(3)
    expect(page.get_by_text(re.compile("cm from the original"))).to_be_visible()
    assert {"with", "k"} <= query_of(page).keys()
    assert lit(page) > 100
    page.reload()
    expect(player(page).locator(".head")).to_have_count(3)
    page.get_by_role("region", name="Similar motions").get_by_role("link").first.click()
    expect(page).to_have_url(re.compile(r"/clips/clip_\w+$"))
    page.go_back()
    expect(player(page).locator(".head")).to_have_count(3)


def test_the_page_says_what_is_known(page: Page, open_clip: OpenClip) -> None:
    clip = open_clip(page)
    seen = page.get_by_role("region", name="What Kinedex sees")
    expect(seen).to_contain_text("kick")
    expect(page.get_by_role("region", name="The recording")).to_contain_text("BVH")
    page.get_by_role("button", name="Export").click()
    with page.expect_download() as download:
        page.get_by_role("link", name="NPZ").click()
    assert download.value.suggested_filename.endswith(".npz")
    assert clip["id"] in page.url


def test_a_clip_that_is_not_there_is_said(browser: Browser, demo_service: Live) -> None:
    with opened(browser, demo_service.url, expected=("404",)) as page:
        page.goto("/clips/nope")
        expect(page.get_by_role("alert").filter(has_text="nope")).to_be_visible()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, open_clip: OpenClip, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        open_clip(page)
        expect(page.get_by_role("region", name="What Kinedex sees")).to_contain_text("kick")
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
