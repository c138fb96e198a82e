"""Two clips compared moment by moment, in the browser."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx2
import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of


@dataclass(frozen=True)
class Pair:
    """Two clips of the demo library, and their alignment as the API has it."""

    a: dict[str, Any]
    b: dict[str, Any]
    alignment: dict[str, Any]

    @property
    def address(self) -> str:
        return f"/compare?a={self.a['id']}&b={self.b['id']}"

    @property
    def seconds(self) -> float:
        """The length of the path by the common time."""
        return self.common(self.alignment["path"][-1])

    def common(self, times: list[float]) -> float:
        """The time from the start of the path, which begins where the clips begin to move."""
        return (sum(times) - sum(self.alignment["path"][0])) / 2

    def worst(self) -> str:
        means = self.alignment["mean_differences"]
        return str(self.alignment["joints"][means.index(max(means))])


@pytest.fixture(scope="module")
def pair(demo_service: Live) -> Pair:
    with demo_service.client() as client:
        a, b = (_clip(client, person) for person in ("ada", "bruno"))
        path = f"/v1/clips/{a['id']}/alignment"
        return Pair(a, b, client.get(path, params={"other": b["id"]}).json())


def _clip(client: httpx2.Client, person: str) -> dict[str, Any]:
    asked = {"person": person, "task": "kick"}
    clip: dict[str, Any] = client.get("/v1/clips", params=asked).json()["items"][0]
    return clip


def _player(page: Page) -> Locator:
    return page.get_by_role("region", name="Player of both clips")


def _slider(page: Page) -> Locator:
    return _player(page).get_by_role("slider", name="Time")


def _open(page: Page, address: str) -> None:
    page.goto(address)
    expect(_player(page)).to_have_attribute("data-ready", "")
    expect(page.locator(".curve canvas")).to_be_visible()


def _of(seconds: float) -> re.Pattern[str]:
    """What the time line says of its length."""
    return re.compile(re.escape(f" of {seconds:.2f} seconds"))


def _query(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def _joints(page: Page) -> Locator:
    return page.get_by_role("region", name="Joints by difference").get_by_role("button")


def test_both_play_along_the_path(page: Page, pair: Pair) -> None:
    _open(page, pair.address)
    expect(_slider(page)).to_have_attribute("aria-valuetext", _of(pair.seconds))
    assert colors_of(_player(page).locator("canvas")) > 100
    expect(_slider(page).locator(".curve")).to_have_attribute("d", re.compile(r"^M0\.0 .*L"))
    page.keyboard.press("End")
    ends = pair.alignment["path"][-1]
    expect(page.get_by_text(f"A {ends[0]:.2f} s, B {ends[1]:.2f} s.")).to_be_visible()
    expect(page.get_by_text(f"Distance by dtw: {pair.alignment['distance']:.3f}")).to_be_visible()


def test_joints_are_listed_by_their_difference_and_can_be_marked(page: Page, pair: Pair) -> None:
    _open(page, pair.address)
    expect(_joints(page)).to_have_count(12)
    first = _joints(page).first
    expect(first).to_contain_text(pair.worst().replace("_", " "))
    expect(first).to_contain_text(f"{max(pair.alignment['mean_differences']) * 100:.0f} cm")
    first.click()
    expect(first).to_have_attribute("aria-pressed", "true")
    assert _query(page)["joint"] == [pair.worst()]
    page.reload()
    expect(first).to_have_attribute("aria-pressed", "true")
    first.click()
    expect(page).not_to_have_url(re.compile("joint="))


def test_marked_joints_and_differences_change_the_picture(page: Page, pair: Pair) -> None:
    canvas = _player(page).locator("canvas")
    pictures = set()
    for query in ("", "&joint=right_foot", "&clock=1", "&view=over"):
        _open(page, f"{pair.address}&t=1{query}")
        pictures.add(canvas.screenshot())
    assert len(pictures) == 4


def test_a_click_on_the_curve_or_on_a_peak_goes_there(page: Page, pair: Pair) -> None:
    _open(page, pair.address)
    peak = pair.alignment["peaks"][0]
    page.get_by_role("region", name="Where they differ most").get_by_role("button").first.click()
    expect(_slider(page)).to_have_attribute(
        "aria-valuetext", re.compile(f"^{pair.common(peak['times']):.2f} of")
    )
    assert _query(page)["joint"] == [peak["joint"]]
    plot = page.locator(".curve .u-over")
    box = plot.bounding_box()
    assert box is not None
    plot.click(position={"x": box["width"] / 2, "y": box["height"] / 2})
    page.wait_for_url(lambda url: abs(_time_of(url) - pair.seconds / 2) < 0.1)


def _time_of(url: str) -> float:
    return float(parse_qs(urlsplit(url).query).get("t", ["0"])[0])


def test_the_same_clock_shows_the_difference_of_tempo(page: Page, pair: Pair) -> None:
    _open(page, pair.address)
    page.get_by_role("button", name="Same clock").click()
    longest = max(pair.a["duration"], pair.b["duration"])
    expect(_slider(page)).to_have_attribute("aria-valuetext", _of(longest))
    expect(page.get_by_text("the bodies keep the colors of their sides")).to_be_visible()
    assert _query(page)["clock"] == ["1"]
    page.get_by_role("button", name="Same moment").click()
    expect(_slider(page)).to_have_attribute("aria-valuetext", _of(pair.seconds))


def test_parts_are_compared_and_can_be_exchanged(
    page: Page, pair: Pair, demo_service: Live
) -> None:
    _open(page, f"{pair.address}&a_from=1&a_to=2.5&b_from=0.5&b_to=2")
    expect(page.get_by_text("1.00 – 2.50 s")).to_be_visible()
    page.get_by_role("button", name="Exchange A and B").click()
    query = _query(page)
    assert (query["a"], query["b"]) == ([pair.b["id"]], [pair.a["id"]])
    assert (query["a_from"], query["b_to"]) == (["0.5"], ["2.5"])
    expect(page.get_by_text("A 0.50 s, B 1.00 s.")).to_be_visible()


def test_what_cannot_be_compared_says_why(browser: Browser, demo_service: Live, pair: Pair) -> None:
    with opened(browser, demo_service.url, expected=("404", "422")) as page:
        page.goto("/compare")
        expect(page.get_by_role("link", name="To the gallery", exact=True)).to_be_visible()
        page.goto(f"/compare?a={pair.a['id']}&b=none")
        expect(page.get_by_text("There is no clip with the id 'none'")).to_be_visible()
        page.goto(f"{pair.address}&b_from=900")
        expect(page.get_by_text("other_start: must be below the duration")).to_be_visible()
        expect(_player(page)).to_have_attribute("data-ready", "")


def test_links_lead_from_hits_from_similar_clips_and_from_the_gallery(
    page: Page, pair: Pair
) -> None:
    own, other = pair.a["id"], pair.b["id"]
    page.goto(f"/search?clip={own}&start=1&end=2&scope=windows")
    page.get_by_role("link", name=re.compile("^Compare with")).first.click()
    expect(_player(page)).to_have_attribute("data-ready", "")
    query = _query(page)
    assert (query["a"], query["a_from"], query["a_to"]) == ([own], ["1"], ["2"])
    assert float(query["b_to"][0]) > float(query.get("b_from", ["0"])[0])
    page.goto(f"/clips/{own}")
    link = page.get_by_role("link", name=re.compile("^Compare with")).first
    assert f"a={own}" in (link.get_attribute("href") or "")
    page.goto(f"/?sel={own}&sel={other}")
    page.get_by_role("region", name="Chosen clips").get_by_role("link", name="Compare").click()
    expect(page).to_have_url(re.compile(f"a={own}&b={other}"))


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_the_page_has_no_serious_fault(
    browser: Browser, demo_service: Live, pair: Pair, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        _open(page, f"{pair.address}&joint=right_foot")
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
