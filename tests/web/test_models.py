"""What was learned: figures, the confusion matrix, the false-accept rate, a fit, and the study."""

from __future__ import annotations

import re
from collections.abc import Iterator
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import demo_clips
from tests.live import Live, serve
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.web.pixels import colors_of


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A library of dances, whose models tests may fit and whose motions they may vote on."""
    with serve(tmp_path_factory.mktemp("own") / "data", worker=True) as live:
        answers = [live.upload(clip) for clip in demo_clips(("ada", "bruno"), ("dance",), takes=2)]
        for answer in answers:
            live.wait_for_job(answer.json()["job"]["id"])
        yield live


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def matrix(page: Page) -> Locator:
    return page.get_by_role("region", name="What was taken for what")


def test_figures_are_shown_by_method(page: Page) -> None:
    page.goto("/models")
    figures = page.get_by_role("table", name="Shares of recognized clips by method")
    expect(figures.get_by_role("rowheader", name="Kinedex")).to_be_visible()
    expect(figures.get_by_role("rowheader", name="Always the most frequent")).to_be_visible()
    page.get_by_role("button", name="All models").click()
    model = page.locator("details").filter(has_text="Recognizer")
    expect(model).to_contain_text("version 1, of 12 clips")
    model.locator("summary").click()
    expect(model).to_contain_text("balanced accuracy")
    assert query_of(page) == {"tab": ["all"]}


def test_a_cell_leads_to_its_clips(page: Page) -> None:
    page.goto("/models")
    cell = matrix(page).get_by_role("button", name=re.compile("^kick taken for kick"))
    cell.click()
    behind = page.get_by_role("region", name="Clips of the cell").get_by_role("link")
    expect(behind).to_have_count(int(cell.inner_text()))
    assert query_of(page) == {"label": ["kick"], "guess": ["kick"]}
    page.reload()
    expect(behind.first).to_be_visible()
    page.get_by_label("Persons or tasks").select_option("person")
    expect(matrix(page).get_by_role("rowheader", name="ada")).to_be_visible()
    expect(behind).to_have_count(0)
    page.go_back()
    behind.first.click()
    expect(page).to_have_url(re.compile(r"/clips/clip_\w+$"))


def test_the_false_accept_rate_is_set(page: Page) -> None:
    page.goto("/models")
    slider = page.get_by_role("slider", name=re.compile("^New called known"))
    output = page.locator("output")
    expect(output).to_have_text("both errors have equal weight")
    slider.fill("0.05")
    expect(output).to_have_text("5.0 %")
    page.get_by_role("button", name="Equal weight").click()
    expect(output).to_have_text("both errors have equal weight")


def test_people_tasks_and_words_lead_to_their_clips(page: Page) -> None:
    page.goto("/models?tab=persons")
    expect(page.get_by_role("region", name="List of persons")).to_contain_text("2 persons")
    page.get_by_role("button", name="Words", exact=True).click()
    expect(page.get_by_role("table", name="Figures of words by method")).to_be_visible()
    page.get_by_role("button", name="Tasks", exact=True).click()
    page.get_by_role("region", name="List of tasks").get_by_role("link", name="kick").click()
    expect(page).to_have_url(re.compile(r"/\?task=kick$"))


def test_signatures_are_plotted_compared_and_played(page: Page) -> None:
    page.goto("/models")
    page.get_by_role("button", name="Signatures").click()
    persons = page.get_by_role("group", name="Signatures of persons")
    expect(persons.get_by_role("link")).to_have_count(2)
    tasks = page.get_by_role("group", name="Signatures of tasks")
    expect(tasks.get_by_role("link")).to_have_count(3)
    weights = page.get_by_role("table", name="Weights of clips")
    expect(weights.get_by_role("rowheader")).to_have_count(12)
    player = page.get_by_role("region", name="Player of the eigenmotion")
    expect(player.locator(".head")).to_have_text(["− 2 SD", "mean", "+ 2 SD"])
    assert colors_of(player.locator("canvas")) > 100
    page.get_by_role("combobox", name="Eigenmotion").select_option("3")
    page.get_by_label("Standard deviations").fill("3")
    expect(player.locator(".head")).to_have_text(["− 3 SD", "mean", "+ 3 SD"])
    page.get_by_label("Coordinates").select_option("multilinear")
    expect(persons.get_by_role("link")).to_have_count(2)
    address = query_of(page)
    assert address["eigenmotion"] == ["3"]
    assert (address["deviations"], address["model"]) == (["3"], ["multilinear"])
    page.reload()
    expect(player.locator(".head")).to_have_text(["− 3 SD", "mean", "+ 3 SD"])
    expect(page.get_by_role("heading", name="Eigenmotion 3")).to_be_visible()
    weights.get_by_role("link").first.click()
    expect(page).to_have_url(re.compile(r"/clips/clip_\w+$"))


def test_models_are_fitted_again(browser: Browser, own: Live) -> None:
    with opened(browser, own.url) as page:
        page.goto("/models?tab=all")
        page.get_by_role("button", name="Fit again").click()
        expect(page.get_by_text("The models are fitted.")).to_be_visible(timeout=120_000)
        expect(page.get_by_role("button", name="Fit again")).to_be_visible()


def test_a_pair_is_judged_blindly_and_counted(browser: Browser, own: Live) -> None:
    with opened(browser, own.url) as page:
        page.goto("/models?tab=all")
        page.get_by_role("link", name="Blind study").click()
        page.get_by_role("button", name="Show the first pair").click()
        player = page.get_by_role("region", name="Player of the pair")
        expect(player.locator(".head")).to_have_count(3)
        assert colors_of(player.locator("canvas")) > 100
        first = query_of(page)["pair"]
        page.keyboard.press("1")
        expect(page.get_by_text("1 vote on this visit.")).to_be_visible()
        expect(page).not_to_have_url(re.compile(re.escape(first[0])))
        page.get_by_role("button", name="Votes so far").click()
        votes = page.get_by_role("region", name="Votes so far").get_by_role("row", name="All")
        expect(votes).to_contain_text("1")
        page.reload()
        expect(player.locator(".head")).to_have_count(3)
        expect(votes).to_be_visible()


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        for address, shown in (
            ("/models?label=kick&guess=kick", page.get_by_role("region", name="Clips of the cell")),
            ("/models?tab=persons", page.get_by_role("region", name="List of persons")),
            ("/models?tab=signatures", page.get_by_role("table", name="Weights of clips")),
            ("/models?tab=words", page.get_by_role("table")),
            ("/models?tab=all", page.locator("details").first),
            ("/study?tally=1", page.get_by_role("region", name="Votes so far")),
        ):
            page.goto(address)
            expect(shown).to_be_visible()
            assert serious_faults(page) == [], address
            assert page.evaluate("document.documentElement.scrollWidth <= innerWidth"), address
