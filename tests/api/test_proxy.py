"""Behind a reverse proxy: paths below a prefix, and forwarded headers of trusted proxies only."""

from __future__ import annotations

import http.client
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlsplit

import httpx2
import pytest

from tests.live import NO_TLS, Live, serve

PREFIX = "/kinedex"
HTTPS = {"X-Forwarded-Proto": "https", "X-Forwarded-For": "203.0.113.7"}


@contextmanager
def proxied(live: Live, headers: dict[str, str]) -> Iterator[str]:
    """A proxy that removes PREFIX and adds headers; yields its address with the prefix."""
    target = urlsplit(live.url).netloc

    class Proxy(BaseHTTPRequestHandler):
        def do_GET(self) -> None:
            line = http.client.HTTPConnection(target, timeout=300)
            sent = dict(self.headers.items()) | headers
            line.request("GET", self.path.removeprefix(PREFIX), headers=sent)
            answer = line.getresponse()
            body = answer.read()
            self.send_response(answer.status)
            for name, value in answer.getheaders():
                if name.lower() != "transfer-encoding":  # http.client has joined the chunks
                    self.send_header(name, value)
            self.end_headers()
            self.wfile.write(body)
            line.close()

        def log_message(self, *_: object) -> None:
            pass

    server = ThreadingHTTPServer(("127.0.0.1", 0), Proxy)
    thread = threading.Thread(target=server.serve_forever)
    thread.start()
    try:
        yield f"http://127.0.0.1:{server.server_port}{PREFIX}"
    finally:
        server.shutdown()
        thread.join()
        server.server_close()


def get(address: str, path: str, **headers: str) -> httpx2.Response:
    return httpx2.get(address + path, headers=headers, trust_env=False, verify=NO_TLS, timeout=300)


@pytest.fixture(scope="module")
def behind(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    folder: Path = tmp_path_factory.mktemp("proxy") / "data"
    with serve(folder, root_path=PREFIX, trusted_proxies="127.0.0.1") as live:
        yield live


def test_everything_works_below_the_prefix(behind: Live) -> None:
    with proxied(behind, {}) as address:
        assert get(address, "/v1/clips").json()["items"] == []
        assert get(address, "/livez").status_code == 200
        assert f"{PREFIX}/assets/" in get(address, "/").text
        page = get(address, "/docs").text
        assert f"'{PREFIX}/openapi.json'" in page
        for part in page.split('"'):
            if part.startswith(PREFIX):
                assert get(address, part.removeprefix(PREFIX)).status_code == 200
        description = get(address, "/openapi.json").json()
        assert description["servers"] == [{"url": PREFIX}]
        assert get(address, "/v1/nowhere").status_code == 404
        refused = httpx2.put(f"{behind.url}/v1/clips", trust_env=False, verify=NO_TLS)
        assert refused.headers["allow"] == "GET, POST"


def test_a_trusted_proxy_says_that_the_client_uses_https(behind: Live) -> None:
    """The origin of a page at https is then the called address."""
    host = urlsplit(behind.url).netloc
    page = {"Origin": f"https://{host}", "Host": host}
    with proxied(behind, HTTPS) as address:
        assert get(address, "/v1/clips", **page).status_code == 200
    with proxied(behind, {}) as address:
        assert get(address, "/v1/clips", **page).status_code == 403


def test_forwarded_headers_of_others_are_not_believed(idle_service: Live) -> None:
    host = urlsplit(idle_service.url).netloc
    page = {"Origin": f"https://{host}", "Host": host}
    with proxied(idle_service, HTTPS) as address:
        assert get(address, "/v1/clips", **page).status_code == 403


def test_the_log_has_no_line_of_a_failure(behind: Live) -> None:
    lines = [json.loads(line) for line in behind.log.read_text().splitlines()]
    assert not [line for line in lines if line["level"] in {"error", "critical"}]
