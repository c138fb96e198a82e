"""The search page: facets beside the hits, their order, moments, and saved searches."""

from __future__ import annotations

import re
from urllib.parse import parse_qs, urlsplit

from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import demo_clips
from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import opened


def hits(page: Page) -> Locator:
    return page.get_by_role("list", name="Hits").get_by_role("listitem")


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def saved(page: Page) -> Locator:
    return page.get_by_role("region", name="Saved search", exact=True)


def test_facets_count_the_hits_and_refine_them(page: Page) -> None:
    with page.expect_response("**/v1/search?fields=rank") as answer:
        page.goto("/search?q=wave")
    (ada,) = [
        one["count"]
        for one in answer.value.json()["facets"]["person"]["values"]
        if one["value"] == "ada"
    ]
    person = page.get_by_role("complementary", name="Refine").get_by_role("list", name="Person")
    expect(person.get_by_role("button", name=re.compile(rf"^ada\s*{ada}$"))).to_be_visible()
    person.get_by_role("button", name="Without ada").press("Enter")
    expect(page).to_have_url(re.compile("not_person=ada"))
    expect(hits(page).filter(has_text="bruno")).not_to_have_count(0)
    expect(hits(page).filter(has_text="ada")).to_have_count(0)
    person.get_by_role("button", name=re.compile("^ada")).press("Enter")
    expect(hits(page).filter(has_text="bruno")).to_have_count(0)
    assert query_of(page) == {"q": ["wave"], "person": ["ada"]}
    page.get_by_label("Order").select_option("-duration")
    expect(page).to_have_url(re.compile("order=-duration"))
    texts = hits(page).locator(".facts").all_inner_texts()
    lengths = [float(found[1]) for text in texts if (found := re.search(r"([\d.]+) s$", text))]
    assert len(lengths) > 1
    assert lengths == sorted(lengths, reverse=True)


def test_hits_are_grouped_diverse_and_good_enough(page: Page) -> None:
    page.goto("/search?q=wave")
    expect(hits(page).first).to_contain_text("wave")
    page.get_by_label("Group by").select_option("person")
    expect(hits(page)).to_have_count(2)
    expect(hits(page).first).to_contain_text(re.compile(r"Best of \d+ hits of (ada|bruno)"))
    page.get_by_label("Group by").select_option("")
    page.get_by_label("At least").select_option("0.5")
    page.get_by_role("button", name="Diverse").click()
    expect(hits(page).first).to_contain_text("wave")
    expect(hits(page).filter(has_text="walk")).to_have_count(0)
    assert query_of(page) == {"q": ["wave"], "least": ["0.5"], "diverse": ["1"]}
    page.reload()
    expect(page.get_by_label("At least")).to_have_value("0.5")
    expect(page.get_by_role("button", name="Diverse")).to_have_attribute("aria-pressed", "true")
    expect(hits(page).filter(has_text="walk")).to_have_count(0)


def test_words_find_moments_inside_clips(page: Page) -> None:
    page.goto("/search?q=wave")
    page.get_by_label("What is found").select_option("windows")
    expect(hits(page).first).to_contain_text(re.compile(r"\d\.\d\d – \d+\.\d\d s"))
    assert query_of(page) == {"q": ["wave"], "scope": ["windows"]}


def test_a_search_is_saved_run_again_and_tells_what_is_new(
    browser: Browser, workshop: Live
) -> None:
    with opened(browser, workshop.url) as page:
        page.goto("/search?q=kick&not_task=wave")
        page.get_by_role("button", name="Save", exact=True).click()
        page.get_by_label("Name of the search").fill("Kicks")
        page.keyboard.press("Enter")
        expect(saved(page)).to_contain_text("Kicks")
        expect(saved(page)).to_contain_text("0 new hits")

        (clip,) = demo_clips(("chika",), ("kick",), takes=1)
        workshop.wait_for_job(workshop.upload(clip).json()["job"]["id"])
        page.goto("/search")
        listed = page.get_by_role("region", name="Saved searches").get_by_role("listitem")
        expect(listed).to_contain_text("1 new hit")
        assert serious_faults(page) == []
        listed.get_by_role("link", name="1 new hit").click()
        expect(hits(page)).to_have_count(1)
        expect(hits(page)).to_contain_text("chika")
        assert serious_faults(page) == []
        page.get_by_role("button", name="All are seen").click()
        expect(saved(page)).to_contain_text("0 new hits")
        expect(hits(page)).not_to_have_count(1)
        assert query_of(page).keys() == {"q", "not_task", "saved"}

        page.get_by_role("button", name=re.compile("^With kick")).click()
        page.goto("/search")
        listed.get_by_role("button", name="Rename Kicks").click()
        page.get_by_label("Name", exact=True).fill("All kicks")
        page.keyboard.press("Enter")
        listed.get_by_role("button", name="Delete All kicks").click()
        expect(listed).to_have_count(0)
        page.get_by_role("button", name="Undo").click()
        expect(listed).to_have_count(1)
