"""Debian's Chromium, driven by Playwright; no browser is downloaded.

A page that is watched fails its test where it logs an error, breaks the content policy, or asks
for something in vain.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Literal

from playwright.sync_api import Browser, Page, Playwright, Request, expect

from app.api.web_pages import DIST

CHROMIUM = shutil.which("chromium") or "/usr/bin/chromium"
# As on a laptop without a GPU: WebGL is drawn by software, and pages are not drawn by WebGL.
SOFTWARE_GL = [
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-gpu-compositing",
]
# The sandbox needs namespaces that containers and root do not have.
FLAGS = ["--no-sandbox", "--disable-dev-shm-usage", *SOFTWARE_GL]
WIDE = (1280, 800)
Scheme = Literal["light", "dark"]
LOOKS: list[tuple[Scheme, tuple[int, int]]] = [("light", WIDE), ("dark", (390, 844))]
"""Each theme, and each kind of layout: a page that is sound in both of these is sound."""
WAIT_MS = 120_000.0
"""For a state that a page gets to; how fast is no matter of these tests."""
expect.set_options(timeout=WAIT_MS)


def why_not() -> str | None:
    """Why no page can be opened here; None where it can."""
    if not Path(CHROMIUM).exists():
        return "CHROMIUM IS NOT INSTALLED: the pages are not tested (apt-get install chromium)"
    if not (DIST / "index.html").exists():
        return "THE PAGES ARE NOT BUILT: run `make install`"
    return None


def launch(playwright: Playwright) -> Browser:
    """The browser; WebGL is drawn by software."""
    return playwright.chromium.launch(executable_path=CHROMIUM, args=FLAGS)


@contextmanager
def opened(
    browser: Browser,
    url: str,
    *,
    size: tuple[int, int] = WIDE,
    scheme: Scheme = "light",
    expected: tuple[str, ...] = (),
    **options: Any,
) -> Iterator[Page]:
    """An empty page of its own whose relative addresses are of the service at `url`.

    expected: parts of the errors that this test causes. Asserts at the end that there was no
    other error.
    """
    width, height = size
    context = browser.new_context(
        base_url=url,
        viewport={"width": width, "height": height},
        color_scheme=scheme,
        reduced_motion="reduce",
        **options,
    )
    page = context.new_page()
    page.set_default_timeout(WAIT_MS)
    errors: list[str] = []
    page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    page.on("pageerror", lambda error: errors.append(str(error)))
    page.on("requestfailed", lambda request: errors.extend(_failures(request)))
    try:
        yield page
    finally:
        # Calls that a page does not wait for when it is closed are no failures.
        seen = list(errors)
        context.close()
    strange = [error for error in seen if not any(part in error for part in expected)]
    assert not strange, strange


def _failures(request: Request) -> list[str]:
    """How a request failed; none where the page itself took it back, or was left."""
    failure = request.failure or ""
    return [] if "ERR_ABORTED" in failure else [f"{request.url} {failure}"]
