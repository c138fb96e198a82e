"""Pictures of every page in both themes at three widths, for people to look at.

`make screenshots` writes them to `build/screenshots/`, from a demo library that it makes.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from itertools import product
from pathlib import Path

from playwright.sync_api import Browser, sync_playwright

from app.api.guard.page_paths import PAGE_NAMES
from app.demo import demo_clips
from tests.live import Live, serve
from tests.web.browser import Scheme, launch, opened, why_not

FOLDER = Path(__file__).resolve().parents[2] / "build" / "screenshots"
WIDTHS = {390: 844, 1024: 768, 1600: 900}
SCHEMES: tuple[Scheme, ...] = ("light", "dark")
ACTORS, TASKS, TAKES = ("ada", "bruno", "chika", "farid"), ("walk", "wave", "kick", "dance"), 3


def _fill(live: Live) -> str:
    """Make the library; gives the id of one of its clips."""
    answers = [live.upload(clip).json() for clip in demo_clips(ACTORS, TASKS, takes=TAKES)]
    for answer in answers:
        live.wait_for_job(answer["job"]["id"])
    with live.client() as client:
        live.wait_for_job(client.post("/v1/models/fit").json()["job"]["id"])
    return str(answers[-1]["clip"]["id"])


def _addresses(clip_id: str) -> Iterator[tuple[str, str]]:
    """Names of pictures, and what they show."""
    yield "gallery", "/"
    yield "gallery-chosen", f"/?size=s&sel={clip_id}"
    yield "clip", f"/clips/{clip_id}?t=2&ghosts=1&trails=1"
    yield "compare-two", f"/compare?a={clip_id}&b={clip_id}&b_from=0.5&t=1"
    yield "map-lit", "/map?q=wave&pick=kick"
    yield "clip-annotations", f"/clips/{clip_id}?from=0.5&to=2"
    yield "todo-unlabeled", "/todo?kind=unlabeled"
    yield "todo-duplicates", "/todo?kind=duplicates&threshold=0.1"
    yield "todo-outliers", "/todo?kind=outliers"
    yield "models-people", "/models?tab=persons"
    yield "models-words", "/models?tab=words"
    yield "models-signatures", "/models?tab=signatures"
    yield "models-evaluations", "/models?tab=evaluations"
    yield "search-words", "/search?q=wave&q=-left"
    yield "search-clip", f"/search?clip={clip_id}&start=0.5&end=2&scope=windows"
    yield "search-parts", f"/search?ex={clip_id}&ex=-{clip_id}@0.5-1&q=wave&q=-left&why=1"
    for name in PAGE_NAMES:
        if name != "clips":
            yield name, f"/{name}"


def _picture(browser: Browser, live: Live, name: str, address: str, width: int) -> None:
    for scheme in SCHEMES:
        with opened(browser, live.url, size=(width, WIDTHS[width]), scheme=scheme) as page:
            page.goto(address)
            page.wait_for_load_state("networkidle")
            page.screenshot(path=FOLDER / f"{name}-{width}-{scheme}.png")


def main() -> None:
    """Make all pictures. Exits with a message where no browser is there."""
    reason = why_not()
    if reason is not None:
        raise SystemExit(reason)
    FOLDER.mkdir(parents=True, exist_ok=True)
    with (
        tempfile.TemporaryDirectory() as home,
        serve(Path(home) / "data", worker=True) as live,
        sync_playwright() as playwright,
    ):
        browser = launch(playwright)
        for (name, address), width in product(_addresses(_fill(live)), WIDTHS):
            _picture(browser, live, name, address, width)
        browser.close()
    print(f"look at {FOLDER}")


if __name__ == "__main__":
    main()
