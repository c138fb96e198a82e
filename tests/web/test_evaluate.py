"""Evaluations: started with options, followed, compared, deleted, and read without a mouse."""

from __future__ import annotations

import json
import re
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Page, expect

from tests.live import Live
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of

TAB = "/models?tab=evaluations"


@pytest.fixture(scope="module")
def symbols(demo_service: Live) -> list[str]:
    """The ids of two evaluations of the symbol space."""
    return [judged(demo_service, kind="symbols") for _ in range(2)]


def judged(service: Live, **body: object) -> str:
    """Judge, and give the id of the result."""
    with service.client() as client:
        job = client.post("/v1/evaluations", json=body).json()["job"]
    return str(service.wait_for_job(job["id"])["result"]["evaluation_id"])


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def test_an_evaluation_is_started_with_options_and_its_result_is_shown(page: Page) -> None:
    page.goto(TAB)
    page.get_by_role("button", name="Search by example").click()
    page.get_by_text("Options", exact=True).first.click()
    page.get_by_label("Figures also by").select_option("task")
    page.get_by_role("checkbox", name="vector").check()
    expect(page).to_have_url(re.compile("kind=retrieval.*by=task.*method=vector"))
    page.reload()
    page.get_by_role("button", name="Start").click()
    table = page.get_by_role("table", name="Clips of the same task among the nearest")
    expect(table.get_by_role("rowheader", name="Motion vectors")).to_be_visible()
    expect(page.get_by_role("region", name="By group").first).to_contain_text("kick")
    matrix = page.get_by_role("table").filter(has_text="Each row is what the clips are")
    matrix.get_by_role("link", name="kick").click()
    expect(page).to_have_url(re.compile(r"/\?task=kick$"))
    page.go_back()
    expect(table).to_be_visible()


def test_a_failed_evaluation_says_what_is_missing(page: Page) -> None:
    page.goto(f"{TAB}&kind=keyposes")
    page.get_by_role("button", name="Start").click()
    reason = page.get_by_role("alert").filter(has_text="keyposes that a person annotated")
    expect(reason).to_be_visible()


def test_a_result_is_compared_with_the_one_before_it(page: Page, symbols: list[str]) -> None:
    page.goto(f"{TAB}&evaluation={symbols[1]}")
    page.get_by_text("Compared with the evaluation before").click()
    table = page.get_by_role("table", name="What changed since the evaluation before")
    expect(table.get_by_role("row")).to_have_count(4)
    expect(table).to_contain_text("the same")


def test_a_plot_is_drawn(page: Page, symbols: list[str]) -> None:
    page.goto(f"{TAB}&evaluation={symbols[0]}")
    plot = page.get_by_role("img", name=re.compile("^Error by the number of dimensions"))
    expect(plot.locator("canvas")).to_be_visible()
    assert colors_of(plot.locator("canvas")) > 10


def test_the_document_is_saved_as_a_file(page: Page, symbols: list[str], tmp_path: Path) -> None:
    page.goto(f"{TAB}&evaluation={symbols[0]}")
    with page.expect_download() as download:
        page.get_by_role("link", name="JSON").click()
    file = tmp_path / download.value.suggested_filename
    download.value.save_as(file)
    assert file.name == "kinedex-symbols.json"
    assert json.loads(file.read_text())["symbols"] == 12


def test_a_deletion_is_taken_back_or_done(page: Page, demo_service: Live) -> None:
    kept = judged(demo_service, kind="symbols")
    page.goto(f"{TAB}&evaluation={kept}")
    rows = page.get_by_role("table", name="Evaluations so far").get_by_role("row")
    expect(rows.nth(1)).to_be_visible()
    count = rows.count()
    delete = page.get_by_role("button", name=re.compile("^Delete Symbol space")).first
    delete.click()
    expect(rows).to_have_count(count - 1)
    page.get_by_role("button", name="Undo").click()
    expect(rows).to_have_count(count)
    delete.click()
    with page.expect_response(lambda answer: answer.request.method == "DELETE") as told:
        page.get_by_role("button", name="Dismiss").click()
    assert told.value.url.endswith(kept)
    expect(rows).to_have_count(count - 1)


def test_the_keyboard_alone_is_enough(page: Page, symbols: list[str]) -> None:
    page.goto(TAB)
    page.get_by_role("button", name="Symbol space", exact=True).focus()
    page.keyboard.press("Enter")
    assert query_of(page)["kind"] == ["symbols"]
    page.get_by_role("link", name="Symbol space").first.focus()
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name=re.compile("^Symbol space,"))).to_be_in_viewport()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, symbols: list[str], scheme: Scheme, size: tuple[int, int]
) -> None:
    made = judged(demo_service, kind="recognition", methods=["default", "prior"])
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        for name in (made, symbols[1]):
            page.goto(f"{TAB}&evaluation={name}")
            expect(page.get_by_role("img", name=re.compile(" over ")).first).to_be_visible()
            page.get_by_text("Options", exact=True).first.click()
            assert serious_faults(page) == []
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
