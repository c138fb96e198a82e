"""The page of the work: what the library holds, jobs, imports; and the first visit."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from app.demo import demo_clips
from tests.live import Live, serve
from tests.web.accessibility import serious_faults
from tests.web.browser import LOOKS, Scheme, opened
from tests.zip_archives import zip_archive


def test_the_library_and_its_jobs_are_shown(page: Page) -> None:
    page.goto("/live")
    library = page.get_by_role("region", name="The library")
    expect(library.get_by_role("link", name=re.compile("clips ready"))).to_contain_text("12")
    jobs = page.get_by_role("list", name="Jobs").get_by_role("listitem")
    expect(jobs.filter(has_text="Analysis").get_by_role("link").first).to_have_attribute(
        "href", re.compile(r"^/clips/clip_\w+$")
    )
    page.get_by_role("button", name="Fits").click()
    expect(jobs.filter(has_text="Analysis")).to_have_count(0)
    expect(jobs.filter(has_text="Fit of the models").first).to_contain_text("succeeded")
    page.reload()
    expect(page.get_by_role("button", name="Fits")).to_have_attribute("aria-pressed", "true")
    library.get_by_role("link", name=re.compile("clips failed")).click()
    expect(page).to_have_url(re.compile(r"/\?state=failed$"))


def test_an_import_shows_its_files_and_work_is_canceled(browser: Browser, tmp_path: Path) -> None:
    take = next(demo_clips(("ada",), ("kick",), takes=1))
    archive = zip_archive({"kick.bvh": take.content, "broken.bvh": b"HIERARCHY\nno"}).getvalue()
    with serve(tmp_path / "data", worker=True) as live, live.client() as client:
        sent = client.post("/v1/imports", files={"archive": ("takes.zip", archive)}).json()["job"]
        live.wait_for_job(sent["id"])
        with opened(browser, live.url) as page:
            page.goto("/live?kind=import")
            job = page.get_by_role("list", name="Jobs").get_by_role("listitem").first
            expect(job).to_contain_text("1 new, 1 failed")
            job.get_by_role("button", name="Files").click()
            files = page.get_by_role("list", name="Files of the import").get_by_role("listitem")
            expect(files).to_have_count(2)
            expect(files.first).to_contain_text("broken.bvh")
            expect(files.first).to_contain_text("line 2")
            page.reload()
            expect(files).to_have_count(2)
            files.last.get_by_role("link").click()
            expect(page.get_by_role("heading", name="kick")).to_be_visible()


def test_the_first_visit_offers_the_demo_library(browser: Browser, tmp_path: Path) -> None:
    # Without a worker, so that the 150 clips wait and can be canceled.
    with serve(tmp_path / "data") as live, opened(browser, live.url) as page:
        page.goto("/")
        expect(page.get_by_role("region", name="This library is empty")).to_be_visible()
        assert serious_faults(page) == []
        page.get_by_role("button", name="Make the demo library").click()
        uploads = page.get_by_role("region", name="Uploads")
        expect(uploads).to_contain_text("Demo library")
        expect(page.get_by_role("button", name="Make the demo library")).to_be_disabled()
        page.goto("/live")
        job = page.get_by_role("list", name="Jobs").get_by_role("listitem")
        expect(job).to_contain_text("queued")
        page.get_by_role("button", name="Cancel").click()
        expect(job).to_contain_text("canceled")


@pytest.mark.parametrize(("scheme", "size"), LOOKS)
def test_it_has_no_serious_fault(
    browser: Browser, demo_service: Live, scheme: Scheme, size: tuple[int, int]
) -> None:
    with opened(browser, demo_service.url, size=size, scheme=scheme) as page:
        page.goto("/live")
        expect(page.get_by_role("list", name="Jobs").get_by_role("listitem").first).to_be_visible()
        assert serious_faults(page) == []
        assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
