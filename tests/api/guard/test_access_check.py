"""Other sites, wrong keys and unknown methods are refused on every path."""

from __future__ import annotations

import socket
from collections.abc import Iterator
from urllib.parse import urlsplit

import httpx2
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from starlette.types import Scope

from app.api.guard.own_address import refuse_other_sites
from app.errors import Forbidden
from app.store.keys import KeyRole
from tests.api.conftest import assert_problem
from tests.api.test_service import _make_keys
from tests.live import Live, serve

PATHS = ["/v1/clips", "/docs", "/openapi.json", "/metrics", "/static-offline-docs/swagger-ui.css"]
PATHS += ["/", "/clips/clip_1", "/v1/nowhere"]
OWN_NAMES = ["localhost", "127.0.0.1", "[::1]", "LocalHost"]
STRANGE_HOSTS = [
    *["", "[", "[::1", "::1", "localhost@evil.example", "evil@localhost", "localhost.", "127.1"],
    *["localhost:", "localhost:x", "localhost:0", "localhost:99999", "localhost, evil.example"],
    *["localhost#x", "localhost/x", "localhost.evil.example", "evil.example", "0.0.0.0", "[::]"],
    *["127.0.0.1.evil.example", "localhost:80:80", "2130706433", "localhost?x", "[::1]x"],
]
FETCHED = ("Sec-Fetch-Site", "Sec-Fetch-Mode", "Sec-Fetch-Dest")


def status_of(live: Live, path: str, head: str, method: str = "GET", version: str = "1.1") -> int:
    """Send a request with exactly these headers, also Host, and return the status."""
    address = urlsplit(live.url)
    with socket.create_connection((address.hostname, address.port), timeout=300) as line:
        request = f"{method} {path} HTTP/{version}\r\n{head}Connection: close\r\n\r\n"
        line.sendall(request.encode("latin-1"))
        return int(b"".join(iter(lambda: line.recv(65536), b"")).split(b" ", 2)[1])


@pytest.mark.parametrize("path", PATHS)
def test_only_the_names_of_loopback_are_answered(idle_service: Live, path: str) -> None:
    for host in [*OWN_NAMES, *(f"{name}:1234" for name in OWN_NAMES)]:
        assert status_of(idle_service, path, f"Host: {host}\r\n") in {200, 307, 404}, host
    for host in STRANGE_HOSTS:
        assert status_of(idle_service, path, f"Host: {host}\r\n") == 403, host
    assert status_of(idle_service, path, "", version="1.0") == 403
    assert status_of(idle_service, path, "") == 400
    assert status_of(idle_service, path, "Host: localhost\r\nHost: evil.example\r\n") == 400


@pytest.mark.parametrize("path", ["/livez", "/readyz"])
def test_health_checks_may_use_any_host_name(idle_service: Live, path: str) -> None:
    head = "Host: kinedex.cluster\r\nSec-Fetch-Site: cross-site\r\n"
    assert status_of(idle_service, path, head) == 200


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("method", ["GET", "POST", "OPTIONS"])
def test_an_origin_must_be_the_called_address(idle_service: Live, path: str, method: str) -> None:
    host = urlsplit(idle_service.url).netloc
    port = host.partition(":")[2]
    strange = ["http://[", "null", "", "http://evil.example", f"https://{host}", f"ftp://{host}"]
    strange += [
        "http://localhost",
        f"http://localhost:{port}",
        f"http://{host}/",
        f"http://{host}x",
    ]
    for origin in strange:
        head = f"Host: {host}\r\nOrigin: {origin}\r\nContent-Length: 0\r\n"
        assert status_of(idle_service, path, head, method) == 403, origin
    own = f"Host: {host}\r\nOrigin: http://{host}\r\nContent-Length: 0\r\n"
    assert status_of(idle_service, path, own, method) not in {400, 403, 500}


@pytest.mark.parametrize(
    ("fetched", "opened"),
    [
        (("cross-site", "no-cors", "image"), []),
        (("cross-site", "no-cors", "script"), []),
        (("cross-site", "cors", "empty"), []),
        (("cross-site", "navigate", "iframe"), []),
        (("same-site", "cors", "empty"), []),
        (("odd", "navigate", "empty"), []),
        (("cross-site", "navigate", "document"), ["/", "/clips/clip_1", "/docs"]),
        (("same-origin", "cors", "empty"), PATHS),
        (("none", "navigate", "document"), PATHS),
    ],
)
def test_another_site_may_only_link_to_a_page(
    idle: httpx2.Client, fetched: tuple[str, ...], opened: list[str]
) -> None:
    headers = dict(zip(FETCHED, fetched, strict=True))
    for path in PATHS:
        answer = idle.get(path, headers=headers, follow_redirects=False)
        assert (answer.status_code == 403) == (path not in opened), path
        if answer.status_code == 403:
            assert_problem(answer, 403, "forbidden")


@settings(max_examples=300, deadline=None, derandomize=True, database=None)
@given(host=st.text(st.sampled_from("[]:@.#/?%localhst1270 ,\tx")), origin=st.text())
def test_any_host_and_origin_is_checked_without_an_error(host: str, origin: str) -> None:
    sent = [(b"host", host.encode()), (b"origin", origin.encode("utf-8", "surrogatepass"))]
    scope: Scope = {"type": "http", "method": "GET", "path": "/v1/clips", "scheme": "http"}
    with pytest.raises(Forbidden):
        refuse_other_sites(scope | {"headers": sent})


def test_a_wrong_key_is_refused_even_if_no_key_is_required(idle: httpx2.Client) -> None:
    for headers in ({"X-API-Key": "kx_a_b"}, {"Authorization": "Bearer wrong"}):
        for path in ("/v1/clips", "/metrics"):
            answer = idle.get(path, headers=headers)
            assert_problem(answer, 401, "unauthorized")
            assert answer.headers["www-authenticate"] == "Bearer"
        assert_problem(idle.post("/v1/models/fit", headers=headers), 401, "unauthorized")
        assert idle.get("/livez", headers=headers).status_code == 200
    assert idle.get("/v1/clips", headers={"X-API-Key": ""}).status_code == 200
    assert idle.get("/v1/clips", headers={"Authorization": "Basic eDp5"}).status_code == 200


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Live, dict[KeyRole, str]]]:
    """A service with keys and one slot for each kind of upload."""
    with serve(tmp_path_factory.mktemp("locked") / "data", max_concurrent_uploads=1) as live:
        yield live, _make_keys(live.data_dir)


def test_with_keys_any_host_name_and_site_is_answered(
    locked: tuple[Live, dict[KeyRole, str]],
) -> None:
    live, secrets = locked
    headers = {"Host": "kinedex.example", "Origin": "http://[", "Sec-Fetch-Site": "cross-site"}
    with live.client(headers=headers) as client:
        for path in ("/docs", "/openapi.json"):
            assert client.get(path).status_code == 200
        assert_problem(client.get("/v1/clips"), 401, "unauthorized")
        key = {"X-API-Key": secrets[KeyRole.READ]}
        assert client.get("/v1/clips", headers=key).status_code == 200


@pytest.mark.parametrize("kind", ["multipart/form-data; boundary=x", "application/json", "a/b"])
@pytest.mark.parametrize(
    ("method", "path"),
    [
        ("POST", "/v1/clips"),
        ("POST", "/v1/imports"),
        ("POST", "/v1/search"),
        ("POST", "/v1/search/motion"),
        ("POST", "/v1/search/words"),
        ("POST", "/v1/recognize"),
        ("PATCH", "/v1/clips/x"),
        ("PUT", "/v1/clips/x/keyposes"),
        ("POST", "/v1/nowhere"),
    ],
)
def test_without_a_key_no_body_is_read(
    locked: tuple[Live, dict[KeyRole, str]], method: str, path: str, kind: str
) -> None:
    # The body never comes: a service that waits for it would not answer, and would use its slot.
    head = f"Host: x\r\nContent-Type: {kind}\r\nContent-Length: 1000\r\n"
    assert status_of(locked[0], path, head, method) == 401


def test_unknown_methods_add_nothing_to_the_metrics(idle_service: Live) -> None:
    with idle_service.client() as client:
        client.get("/metrics")
        before = client.get("/metrics").text
        for number in range(3000):
            answer = client.request(f"MADE{number}", "/v1/clips")
        assert_problem(answer, 501, "unknown_method")
        after = client.get("/metrics").text
    assert len(after.splitlines()) == len(before.splitlines())
    assert "MADE" not in after + idle_service.log.read_text()


def test_unknown_paths_share_one_label_of_the_metrics(idle: httpx2.Client) -> None:
    idle.get("/made/up/0")
    lines = len(idle.get("/metrics").text.splitlines())
    for number in range(1, 50):
        assert idle.get(f"/made/up/{number}").status_code == 404
    assert len(idle.get("/metrics").text.splitlines()) == lines
