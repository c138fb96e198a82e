"""The player: pictures a second with four bodies, and the bytes that its page loads.

Run: pytest -m bench -s tests/bench/test_player.py
Chromium draws by software (SwiftShader), as on a laptop without a GPU. Four clips play in step, in
a window of 1280 x 800. A picture counts when the page has shown another time. The processor time
of the browser with all its processes is printed too: it says more on a busy machine. The figures
are not asserted (target of issue 11: 30 pictures a second).
"""

from __future__ import annotations

import gzip
import os
import re
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import psutil
import pytest
from playwright.sync_api import Page, expect, sync_playwright

from app.api.web_pages import DIST
from app.demo import demo_clips
from tests.bench.page import Section
from tests.bench.processes import tree_of
from tests.live import Live, serve
from tests.web.browser import launch, opened, why_not

FIGURES = Section(
    "player",
    "The player in a browser that draws by software",
    trials="ten seconds for each number of bodies and each view",
)

pytestmark = pytest.mark.bench

SECONDS = 10
COUNT = """async (seconds) => {
  const slider = document.querySelector("[role=slider]");
  const end = performance.now() + seconds * 1000;
  let [shown, before, longest, at] = [0, "", 0, performance.now()];
  while (at < end) {
    const now = await new Promise(requestAnimationFrame);
    longest = Math.max(longest, now - at);
    at = now;
    if (slider.ariaValueNow !== before) shown += 1;
    before = slider.ariaValueNow;
  }
  return [shown / seconds, longest];
}"""
"""Pictures a second, and the longest time between two in ms."""
VIEWS = {"skin": "", "bones": "&body=bones", "skin, trails": "&trails=1"}


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, list[str]]]:
    """A library of four dances, and their ids."""
    with serve(tmp_path_factory.mktemp("player") / "data", worker=True) as live:
        clips = demo_clips(["ada", "bruno", "chika", "farid"], ["dance"], takes=1)
        answers = [live.upload(clip).json() for clip in clips]
        for answer in answers:
            live.wait_for_job(answer["job"]["id"])
        yield live, [answer["clip"]["id"] for answer in answers]


@pytest.fixture(scope="module")
def page(service: tuple[Live, list[str]]) -> Iterator[Page]:
    reason = why_not()
    if reason is not None:
        pytest.skip(reason)
    with sync_playwright() as playwright:
        browser = launch(playwright)
        # Without fitted models, the page says that it cannot recognize anybody.
        with opened(browser, service[0].url, expected=("409",)) as page:
            yield page
        browser.close()


def _open(page: Page, ids: list[str], view: str) -> float:
    """Open the player of these clips; gives the seconds until it is ready."""
    start = time.perf_counter()
    page.goto(f"/clips/{ids[0]}?with={','.join(ids[1:])}{view}")
    player = page.get_by_role("region", name=re.compile("^Player of"))
    expect(player).to_have_attribute("data-ready", "")
    ready = time.perf_counter() - start
    expect(player.locator(".head")).to_have_count(len(ids) if len(ids) > 1 else 0)
    page.wait_for_load_state("networkidle")
    return ready


def test_pictures_a_second(service: tuple[Live, list[str]], page: Page) -> None:
    ids = service[1]
    FIGURES.print(f"load of the machine before: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
    for count in (1, 4):
        for name, view in VIEWS.items():
            ready = _open(page, ids[:count], view)
            page.keyboard.press("Space")
            before = _browser_seconds()
            rate, longest = page.evaluate(COUNT, SECONDS)
            assert rate > 0
            each = 1e3 * (_browser_seconds() - before) / (rate * SECONDS)
            FIGURES.print(
                f"{count} bodies, {name:<12} {rate:5.1f} pictures/s, at most {longest:4.0f} ms"
                f" apart; {each:3.0f} ms of processor time each; ready after {ready:.1f} s"
            )


def _browser_seconds() -> float:
    """Processor time of the browser that this process has started, and of its processes."""
    total = 0.0
    for process in tree_of(psutil.Process())[1:]:
        with suppress(psutil.Error):
            if "chrom" in process.name():
                times = process.cpu_times()
                total += times.user + times.system
    return total


def test_bytes(service: tuple[Live, list[str]], page: Page) -> None:
    """The scripts of the page of a clip, as a server sends them, gzipped."""
    loaded: set[str] = set()
    page.on("response", lambda answer: loaded.add(answer.url.rpartition("/")[2]))
    _open(page, service[1][:1], "")
    sizes = {
        name: len(gzip.compress(path.read_bytes()))
        for name in sorted(loaded)
        if name.endswith(".js") and (path := _script(name)).exists()
    }
    FIGURES.print(f"scripts of the page of a clip: {sum(sizes.values()) / 1e3:.0f} kB gzipped")
    for part in ("three", "stage", "Player"):
        (size,) = [size for name, size in sizes.items() if name.startswith(part)]
        FIGURES.print(f"  {part:<7} {size / 1e3:4.0f} kB")


def _script(name: str) -> Path:
    return DIST / "assets" / name
