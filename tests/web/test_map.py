"""The map: what it shows, what is seen of a clip, and what the lasso chooses."""

from __future__ import annotations

import re
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, FloatRect, Locator, Page, expect

from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of

STORED = 12
MANY = 100_000
MANY_POINTS = f"""
const own = fetch;
window.fetch = async (request) => {{
  if (!request.url?.includes("/v1/space/columns")) return own(request);
  const whole = await (await own("/v1/space/columns?limit=1")).json();
  const column = (of) => Array.from({{length: {MANY}}}, (_, n) => of(n));
  return Response.json({{
    ...whole,
    total: {MANY},
    clip_ids: column((n) => `clip_${{n}}`),
    points: [column((n) => n % 317), column((n) => Math.floor(n / 317))],
    labels: {{task: {{values: Array.from({{length: 40}}, (_, n) => `task ${{n}}`),
                      codes: column((n) => n % 40)}}}},
  }});
}};
"""
"""A map of many clips, made in the page: to send it takes longer than to draw it."""


def plot(page: Page) -> Locator:
    return page.get_by_role("application", name=re.compile("^Map of clips"))


def box_of(locator: Locator) -> FloatRect:
    box = locator.bounding_box()
    assert box
    return box


def tray(page: Page) -> Locator:
    return page.get_by_role("region", name="Chosen clips")


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def open_map(page: Page, query: str = "", count: int = STORED) -> None:
    page.goto(f"/map{query}")
    expect(plot(page)).to_have_attribute("data-drawn", str(count))


def test_clips_are_points_colored_by_what_is_chosen(page: Page) -> None:
    open_map(page)
    assert colors_of(plot(page)) > 20
    legend = page.get_by_role("region", name="Legend: Task")
    expect(legend.get_by_role("button", name=re.compile("kick"))).to_contain_text("4")
    page.get_by_label("Color").select_option("duration")
    expect(page.get_by_role("region", name="Legend: Duration")).to_be_visible()
    expect(legend).to_be_hidden()
    page.get_by_label("Space").select_option("vectors")
    expect(page.get_by_role("status").filter(has_text="12 clips")).to_be_visible()
    assert query_of(page) == {"color": ["duration"], "space": ["vectors"]}
    page.go_back()
    page.go_back()
    expect(legend).to_be_visible()


def test_measures_color_the_points(page: Page) -> None:
    pictures = set()
    for measure, title in (("speed", "Speed, m/s"), ("energy", "Energy, body lengths/s")):
        open_map(page, f"?color={measure}")
        legend = page.get_by_role("region", name=f"Legend: {title}")
        expect(legend.locator(".ramp")).to_be_visible()
        assert colors_of(plot(page)) > 20
        pictures.add(plot(page).screenshot())
    assert len(pictures) == 2


def test_the_hits_of_a_query_are_lit(page: Page) -> None:
    page.goto("/search?q=kick")
    page.get_by_role("link", name="On the map").click()
    expect(page.get_by_role("status").filter(has_text=re.compile(r"\d hits? lit"))).to_be_visible()
    expect(plot(page)).to_have_attribute("data-drawn", str(STORED))
    page.get_by_role("link", name="Show the hits as a list").click()
    expect(page.get_by_role("list", name="Hits").get_by_role("listitem").first).to_be_visible()


def test_a_clip_is_seen_under_the_pointer_and_opened_by_keyboard(page: Page) -> None:
    open_map(page)
    plot(page).focus()
    page.keyboard.press("Enter")
    closer = page.get_by_role("button", name="Close the card")
    expect(closer).to_be_visible()
    opened_clip = query_of(page)["at"]
    circle = box_of(plot(page).locator("circle"))
    page.reload()
    expect(closer).to_be_visible()
    assert query_of(page)["at"] == opened_clip
    closer.click()
    expect(closer).to_be_hidden()
    page.mouse.move(circle["x"] + circle["width"] / 2, circle["y"] + circle["height"] / 2)
    expect(page.locator(".hover img")).to_be_visible()
    page.mouse.down()
    page.mouse.up()
    expect(closer).to_be_visible()
    page.locator(".open").get_by_role("link").first.click()
    expect(page).to_have_url(re.compile(rf"/clips/{opened_clip[0]}$"))


def test_what_is_seen_of_the_map_is_an_address(page: Page) -> None:
    open_map(page)
    plot(page).focus()
    page.keyboard.press("+")
    page.keyboard.press("ArrowRight")
    expect(page).to_have_url(re.compile("view="))
    seen = query_of(page)["view"]
    page.reload()
    expect(plot(page)).to_have_attribute("data-drawn", str(STORED))
    assert query_of(page)["view"] == seen
    page.get_by_role("button", name="Whole map").click()
    expect(page).not_to_have_url(re.compile("view="))


def test_a_lasso_and_the_legend_choose_clips(page: Page) -> None:
    open_map(page)
    box = box_of(plot(page))
    left, right = box["x"] + 3, box["x"] + box["width"] - 3
    top, bottom = box["y"] + 3, box["y"] + box["height"] - 3
    page.get_by_role("button", name="Lasso").click()
    page.mouse.move(left, top)
    page.mouse.down()
    for x, y in ((right, top), (right, bottom), (left, bottom)):
        page.mouse.move(x, y, steps=4)
    page.mouse.up()
    expect(tray(page).get_by_role("status")).to_have_text(f"{STORED} clips chosen")
    page.reload()
    expect(tray(page).get_by_role("status")).to_have_text(f"{STORED} clips chosen")
    tray(page).get_by_role("button", name="Label").click()
    expect(page.get_by_role("button", name=f"Label {STORED} clips")).to_be_disabled()
    page.keyboard.press("Escape")
    page.get_by_role("button", name=re.compile("^kick")).click()
    expect(tray(page).get_by_role("status")).to_have_text("4 clips chosen")
    assert query_of(page) == {"pick": ["kick"]}
    tray(page).get_by_role("button", name="Choose none").click()
    expect(tray(page)).to_be_hidden()


def test_a_hundred_thousand_clips_are_drawn(page: Page) -> None:
    page.add_init_script(MANY_POINTS)
    open_map(page, count=MANY)
    assert colors_of(plot(page)) > 20


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        open_map(page, "?pick=kick")
        plot(page).focus()
        page.keyboard.press("Enter")
        expect(page.get_by_role("button", name="Close the card")).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
