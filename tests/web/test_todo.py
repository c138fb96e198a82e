"""To do: a queue of clips with doubts, failed clips, and clips without labels, by keyboard."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any
from urllib.parse import parse_qs, urlsplit

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from app.demo import DemoClip, demo_clips
from tests.live import Live, serve, wait_until
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened

FRAME_TIME = re.compile(r"Frame Time: ([\d.]+)")
FASTER = 3
"""So much faster than real that the frame rate is doubted."""
FAILED, UNLABELED = 2, 3


def faster(clip: DemoClip) -> bytes:
    text = clip.content.decode()
    return FRAME_TIME.sub(
        lambda found: f"Frame Time: {float(found[1]) / FASTER:.6f}", text
    ).encode()


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A library with work for each queue; tests take what they need of it."""
    with serve(tmp_path_factory.mktemp("work") / "data", worker=True) as live:
        answers = [
            live.upload(clip) for clip in demo_clips(("ada", "bruno"), ("walk", "kick"), takes=2)
        ]
        doubted = next(iter(demo_clips(("ada",), ("run",), takes=1)))
        bare = list(demo_clips(("chika",), ("walk", "kick", "wave"), takes=1))
        with live.client() as client:
            for name, content, labels in [
                ("fast.bvh", faster(doubted), {"person": "ada", "task": "run"}),
                *((f"broken_{n}.bvh", b"HIERARCHY\nno %d" % n, {}) for n in range(FAILED)),
                *((f"bare_{n}.bvh", one.content, {}) for n, one in enumerate(bare)),
            ]:
                files = {"file": (name, content)}
                answers.append(client.post("/v1/clips", files=files, data=labels))
            for answer in answers:
                live.wait_for_job(answer.json()["job"]["id"])
            live.wait_for_job(client.post("/v1/models/fit").json()["job"]["id"])
        yield live


def clips_of(live: Live, **filters: str) -> list[dict[str, Any]]:
    with live.client() as client:
        found: list[dict[str, Any]] = client.get("/v1/clips", params=filters).json()["items"]
    return found


def queue(page: Page) -> Locator:
    return page.get_by_role("list", name="Queue").get_by_role("listitem")


def present(page: Page) -> Locator:
    return page.locator("h2 a")


def query_of(page: Page) -> dict[str, list[str]]:
    return parse_qs(urlsplit(page.url).query)


def test_a_doubt_says_why_and_is_settled_by_a_key(browser: Browser, work: Live) -> None:
    with opened(browser, work.url) as page:
        page.goto("/todo")
        expect(present(page)).to_have_text("fast")
        expect(page.get_by_role("region", name="Doubts")).to_contain_text("frame")
        likely = page.get_by_role("button", name=re.compile("^Use .* frames a second"))
        expect(likely).to_be_visible()
        page.keyboard.press("a")
        expect(page.get_by_text("fast is changed.")).to_be_visible()
        wait_until(lambda: clips_of(work, q="fast")[0]["warnings"] == [], 60)
        page.goto("/todo?kind=doubts")
        expect(page.get_by_text("No clip has a doubt.")).to_be_visible()


def test_failed_files_are_deleted_and_that_is_taken_back(browser: Browser, work: Live) -> None:
    with opened(browser, work.url) as page:
        page.goto("/todo?kind=failed")
        expect(queue(page)).to_have_count(FAILED)
        expect(page.get_by_role("region", name="This file cannot be used")).to_contain_text(
            "line 2"
        )
        first = present(page).text_content() or ""
        page.keyboard.press("j")
        expect(present(page)).not_to_have_text(first)
        page.keyboard.press("k")
        expect(present(page)).to_have_text(first)
        page.keyboard.press("d")
        expect(queue(page)).to_have_count(FAILED - 1)
        page.get_by_role("button", name="Undo").click()
        expect(queue(page)).to_have_count(FAILED)
        page.keyboard.press("s")
        expect(queue(page)).to_have_count(FAILED - 1)
        assert len(clips_of(work, state="failed")) == FAILED


def test_suggestions_are_accepted_by_keyboard(browser: Browser, work: Live) -> None:
    with opened(browser, work.url) as page:
        page.goto("/todo?kind=unlabeled")
        expect(queue(page)).to_have_count(UNLABELED)
        offered = page.get_by_role("region", name="Suggestions").get_by_role("checkbox")
        expect(offered.first).to_be_visible()
        name = present(page).text_content() or ""
        was_chosen = offered.first.is_checked()
        page.keyboard.press("1")
        expect(offered.first).to_be_checked(checked=not was_chosen)
        if was_chosen:
            page.keyboard.press("1")
        expect(offered.first).to_be_checked()
        page.keyboard.press("a")
        expect(page.get_by_text(f"{name} is changed.")).to_be_visible()
        expect(queue(page)).to_have_count(UNLABELED - 1)
        assert clips_of(work, q=name)[0]["task"] is not None
        page.get_by_role("button", name="Undo").click()
        expect(queue(page)).to_have_count(UNLABELED)
        expect(present(page)).to_have_text(name)
        assert clips_of(work, q=name)[0]["task"] is None


def test_what_is_looked_at_is_an_address(browser: Browser, work: Live) -> None:
    with opened(browser, work.url) as page:
        page.goto("/todo")
        page.get_by_role("button", name="Without labels").click()
        page.get_by_label("without").select_option("words")
        expect(queue(page)).to_have_count(UNLABELED + 1)
        page.keyboard.press("j")
        expect(page).to_have_url(re.compile("at="))
        name = present(page).text_content() or ""
        assert query_of(page).keys() == {"kind", "lacks", "at"}
        page.reload()
        expect(present(page)).to_have_text(name)
        present(page).click()
        expect(page).to_have_url(re.compile("/clips/"))


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, work: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, work.url, size=size, scheme=scheme) as page:
        page.goto("/todo?kind=unlabeled")
        suggestions = page.get_by_role("region", name="Suggestions")
        expect(suggestions.get_by_role("checkbox").first).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.goto("/todo?kind=failed")
        expect(queue(page)).to_have_count(FAILED)
        assert serious_faults(page) == []
