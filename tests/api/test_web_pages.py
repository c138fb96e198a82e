"""The pages as files: addresses, headers, compressed forms, sizes. `tests/web` opens them."""

from __future__ import annotations

import gzip
import json
import re
from pathlib import Path

import httpx2
import pytest
from fastapi import FastAPI
from starlette.testclient import TestClient

from app.api.guard.page_paths import PAGE_NAMES
from app.api.web_pages import DIST, install_pages
from tests.api.conftest import assert_problem

ROOT = Path(__file__).resolve().parents[2]
FIRST_PAGE_BYTES = 100_000
"""Gzipped JavaScript of the gallery with the shell around it."""

needs_pages = pytest.mark.skipif(
    not (DIST / "index.html").exists(), reason="THE PAGES ARE NOT BUILT: run `make install`"
)


def _names(page: str) -> list[str]:
    return re.findall(r'"/assets/([^"]+)"', page)


@needs_pages
@pytest.mark.parametrize("path", ["/", "/clips/clip_1", "/search?q=a", "/clips/a/b"])
def test_every_address_of_a_page_is_the_same_page(idle: httpx2.Client, path: str) -> None:
    page = idle.get(path)
    assert page.status_code == 200
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert page.text == idle.get("/").text
    assert idle.head(path).status_code == 200


def test_other_addresses_are_problems(idle: httpx2.Client) -> None:
    assert_problem(idle.get("/nowhere"), 404, "not_found")
    assert_problem(idle.get("/assets/nowhere.js"), 404, "not_found")


@needs_pages
def test_a_page_runs_no_script_of_others(idle: httpx2.Client) -> None:
    page = idle.get("/")
    policy = page.headers["content-security-policy"]
    assert "unsafe" not in policy
    assert "default-src 'none'" in policy
    assert "script-src 'self';" in policy
    assert not re.search(r"<script(?![^>]*\ssrc=)|\sstyle=|\son\w+=|https?://", page.text)


@needs_pages
def test_a_page_is_asked_for_again_and_its_files_are_kept(idle: httpx2.Client) -> None:
    page = idle.get("/")
    assert page.headers["cache-control"] == "no-cache"
    again = idle.get("/", headers={"If-None-Match": page.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    for name in _names(page.text):
        answer = idle.get(f"/assets/{name}")
        assert answer.status_code == 200
        assert "immutable" in answer.headers["cache-control"]
        known = {"If-None-Match": answer.headers["etag"]}
        assert idle.get(f"/assets/{name}", headers=known).status_code == 304


@needs_pages
@pytest.mark.parametrize(
    ("taken", "sent"),
    [("identity", None), ("gzip", "gzip"), ("gzip, deflate, br;q=0.9", "br"), ("brotli", None)],
)
def test_files_come_compressed_as_the_client_takes_them(
    idle: httpx2.Client, taken: str, sent: str | None
) -> None:
    script = next(name for name in _names(idle.get("/").text) if name.endswith(".js"))
    with idle.stream("GET", f"/assets/{script}", headers={"Accept-Encoding": taken}) as answer:
        raw = b"".join(answer.iter_raw())
    assert answer.headers.get("content-encoding") == sent
    assert answer.headers["content-type"].startswith("text/javascript")
    assert set(answer.headers["vary"].split(", ")) == {"Accept-Encoding"}
    plain = (DIST / "assets" / script).read_bytes()
    if sent == "gzip":
        assert gzip.decompress(raw) == plain
    assert (raw == plain) == (sent is None)


@needs_pages
def test_the_first_page_is_small() -> None:
    chunks = json.loads((DIST / "manifest.json").read_text())
    gallery = next(key for key, chunk in chunks.items() if chunk.get("name") == "gallery")
    wanted = ["index.html", gallery]
    first: set[str] = set()
    while wanted:
        name = wanted.pop()
        if name not in first:
            first.add(name)
            wanted += chunks[name].get("imports", [])
    sizes = {name: (DIST / f"{chunks[name]['file']}.gz").stat().st_size for name in first}
    assert sum(sizes.values()) <= FIRST_PAGE_BYTES, sizes


def test_the_application_and_the_server_know_the_same_pages() -> None:
    source = (ROOT / "app" / "web" / "src" / "pages" / "pages.ts").read_text()
    assert set(re.findall(r'name: "(\w+)"', source)) == set(PAGE_NAMES)


def test_pages_that_are_not_built_say_what_to_do(tmp_path: Path) -> None:
    app = FastAPI()
    app.state.gates = None
    install_pages(app, tmp_path)
    answer = TestClient(app).get("/")
    assert answer.status_code == 404
    assert "make install" in answer.text
    assert "/docs" in answer.text


def test_pages_stand_under_the_path_of_a_proxy(tmp_path: Path) -> None:
    (tmp_path / "index.html").write_text('<script src="./assets/a.js"></script>')
    app = FastAPI()
    app.state.gates = None
    install_pages(app, tmp_path)
    page = TestClient(app, root_path="/motion").get("/motion/search")
    assert page.text == '<script src="/motion/assets/a.js"></script>'
