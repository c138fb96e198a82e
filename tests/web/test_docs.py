"""`/docs` in a real browser: every form is shown, and every Execute works as it is prefilled."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, FilePayload, Locator, Page

from app.config import Settings
from app.demo import demo_clips
from app.demo.dances.wav import write_wav
from app.services.clips import catalogue
from app.services.clips.recordings import NewRecording
from app.services.examples import add_examples
from app.services.library.library import Library
from app.store.store import Store
from app.store.upkeep.backup import back_up
from tests.libraries import settings_for, work
from tests.live import Live, serve

pytestmark = pytest.mark.slow

LAST = (
    "delete_webhook",
    "delete_pair",
    "forget_named_keyposes",
    "delete_audio",
    "cancel_or_delete_job",
)
LAST += ("delete_clip", "forget_person")
"""Calls that delete what the examples of other calls name, in an order in which all work."""
WAIT_MS = 120_000.0
"""For an answer, and for the page to show it: on a busy machine both take long."""


@pytest.fixture(scope="module")
def own_demo(demo_service: Live, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    """A copy of the demo library that tests may change; without a worker, so that it stays."""
    folder = tmp_path_factory.mktemp("docs") / "data"
    _copy(Settings(data_dir=demo_service.data_dir), folder)
    _complete(settings_for(folder.parent))
    with serve(folder) as live:
        yield live


def _copy(settings: Settings, folder: Path) -> None:
    store = Store.open(settings.database, settings.files_dir)
    back_up(store, folder)
    store.close()


def _complete(settings: Settings) -> None:
    """Add what `kinedex demo` has too: a clip with a recording, and a pair of the study."""
    take = next(demo_clips(["ada"], ["walk"], takes=1))
    lib = Library.open(settings)
    sound = NewRecording(
        io.BytesIO(write_wav(np.random.default_rng(1).normal(scale=0.1, size=8000), 8000)),
        "walk.wav",
    )
    catalogue.create_clip(lib, io.BytesIO(take.content), take.path, recording=sound)
    work(settings)
    add_examples(lib)
    lib.close()


@pytest.fixture(scope="module")
def docs(browser: Browser, own_demo: Live) -> Iterator[Page]:
    """The page; it may log no error but those that a test expects."""
    page = browser.new_page(base_url=own_demo.url, viewport={"width": 1280, "height": 1600})
    page.set_default_timeout(WAIT_MS)
    errors: list[str] = []
    page.on("console", lambda line: errors.append(line.text) if line.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.goto("/docs")
    page.locator(".opblock").first.wait_for()
    yield page
    page.close()
    assert errors == []


def opened(page: Page, operation: str) -> Locator:
    """The block of a call, with its forms."""
    block = page.locator(f".opblock[id$='-{operation}']")
    block.locator(".opblock-summary-control").click()
    block.locator("button.execute").wait_for()
    return block


def _files(block: Locator) -> None:
    """Choose a file for each file that a form requires; Swagger UI cannot prefill these."""
    take = next(demo_clips(["chika"], ["wave"], takes=1))
    archive = io.BytesIO()
    with zipfile.ZipFile(archive, "w") as content:
        content.writestr("wave.bvh", take.content)
    chosen: dict[str, FilePayload] = {
        "file": {"name": "wave.bvh", "mimeType": "text/plain", "buffer": take.content},
        "archive": {"name": "a.zip", "mimeType": "application/zip", "buffer": archive.getvalue()},
    }
    for name, file in chosen.items():
        row = block.locator(f"tr[data-property-name={name}]")
        if row.count() and row.locator(".parameter__name.required").count():
            row.locator("input[type=file]").set_input_files(file)


def test_every_execute_works_as_it_is_prefilled(docs: Page) -> None:
    names = [
        str(block.get_attribute("id")).rpartition("-")[2]
        for block in docs.locator(".opblock").all()
    ]
    assert len(names) > 50
    assert set(LAST) < set(names)
    failed = {}
    for name in [*(name for name in names if name not in LAST), *LAST]:
        block = opened(docs, name)
        assert block.get_by_text("Could not render").count() == 0, name
        _files(block)
        with docs.expect_response(lambda answer: "/static-" not in answer.url) as sent:
            block.locator("button.execute").click()
        if not sent.value.ok:
            failed[name] = (sent.value.url, sent.value.status)
        block.locator(".opblock-summary-control").click()
    assert not failed


def test_each_status_shows_its_own_example(docs: Page) -> None:
    block = opened(docs, "get_clip")
    for status in ("401", "403", "404", "422", "500", "503"):
        row = block.locator(f"tr.response[data-code='{status}']")
        assert f'"status": {status}' in row.locator(".example, .highlight-code").first.inner_text()
    block.locator(".opblock-summary-control").click()


def test_examples_of_problems_have_the_status_that_they_explain(own_demo: Live) -> None:
    with own_demo.client() as client:
        description: dict[str, Any] = client.get("/openapi.json").json()
    for path, item in description["paths"].items():
        for operation in item.values():
            for status, response in operation["responses"].items():
                problem = response.get("content", {}).get("application/problem+json")
                if problem is not None:
                    assert problem["example"]["status"] == int(status), path
