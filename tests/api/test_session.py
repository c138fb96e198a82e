"""Signing in with a browser: the cookie stands for a key, for pages of this address only."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from app.api.guard.access_check import COOKIE
from app.config import load_settings
from app.store import keys
from app.store.key_role import KeyRole
from app.store.store import Store
from tests.api.conftest import assert_problem
from tests.live import Live, serve

READ, WRITE = KeyRole.READ, KeyRole.WRITE
Locked = tuple[Live, dict[KeyRole, str]]


def _store(data_dir: Path) -> Store:
    settings = load_settings(data_dir=data_dir)
    return Store.open(settings.database, settings.files_dir)


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Locked]:
    with serve(tmp_path_factory.mktemp("locked") / "data") as live:
        store = _store(live.data_dir)
        with store.write() as tx:
            secrets = {role: keys.create(tx, role, role.value).secret for role in (READ, WRITE)}
        store.close()
        yield live, secrets


@pytest.fixture
def page(locked: Locked) -> Iterator[httpx2.Client]:
    """What a page of this service sends with every call."""
    live, _ = locked
    with live.client(headers={"Origin": live.url, "Sec-Fetch-Site": "same-origin"}) as client:
        yield client


def _sign_in(page: httpx2.Client, key: str) -> httpx2.Response:
    return page.post("/v1/session", json={"key": key})


def _session(role: str | None, *, keys_needed: bool) -> dict[str, object]:
    return {"keys_needed": keys_needed, "role": role, "source": None, "expires_at": None}


def test_a_cookie_stands_for_the_key(page: httpx2.Client, locked: Locked) -> None:
    assert page.get("/v1/session").json() == _session(None, keys_needed=True)
    assert_problem(page.get("/v1/clips"), 401, "unauthorized")
    answer = _sign_in(page, locked[1][WRITE])
    assert answer.json() == _session("write", keys_needed=True)
    cookie = answer.headers["set-cookie"].lower()
    assert "httponly" in cookie
    assert "samesite=strict" in cookie
    assert locked[1][WRITE] not in str(answer.headers) + answer.text
    assert page.get("/v1/clips").status_code == 200
    assert page.delete("/v1/clips/nope").status_code == 404
    assert page.get("/v1/session").json() == _session("write", keys_needed=True)
    assert not any(secret in locked[0].log.read_text() for secret in locked[1].values())


def test_who_signs_out_is_out(page: httpx2.Client, locked: Locked) -> None:
    _sign_in(page, locked[1][READ])
    token = page.cookies[COOKIE]
    assert page.delete("/v1/session").status_code == 204
    assert COOKIE not in page.cookies
    page.cookies.set(COOKIE, token)
    assert_problem(page.get("/v1/clips"), 401, "unauthorized")


def test_the_role_of_the_key_holds(page: httpx2.Client, locked: Locked) -> None:
    _sign_in(page, locked[1][READ])
    assert_problem(page.delete("/v1/clips/nope"), 403, "forbidden")


def test_a_key_that_is_revoked_ends_its_sessions(page: httpx2.Client, locked: Locked) -> None:
    store = _store(locked[0].data_dir)
    with store.write() as tx:
        made = keys.create(tx, READ, "for a day")
    _sign_in(page, made.secret)
    assert page.get("/v1/clips").status_code == 200
    with store.write() as tx:
        keys.revoke(tx, made.record.id)
    store.close()
    assert_problem(page.get("/v1/clips"), 401, "unauthorized")


@pytest.mark.parametrize("key", ["wrong", "kx_a_b"])
def test_a_wrong_key_signs_nobody_in(page: httpx2.Client, key: str) -> None:
    answer = _sign_in(page, key)
    assert_problem(answer, 401, "unauthorized")
    assert "set-cookie" not in answer.headers


@pytest.mark.parametrize(
    "headers",
    [
        {"Origin": "http://evil.example", "Sec-Fetch-Site": "cross-site"},
        {"Origin": "http://127.0.0.1:1", "Sec-Fetch-Site": "same-site"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
        {"Origin": "ftp://HOST"},
        {"Origin": "HOST"},
        {},
    ],
)
def test_other_sites_cannot_use_the_cookie(
    page: httpx2.Client, locked: Locked, headers: dict[str, str]
) -> None:
    live, secrets = locked
    _sign_in(page, secrets[WRITE])
    host = live.url.removeprefix("http://")
    headers = {name: value.replace("HOST", host) for name, value in headers.items()}
    with live.client(headers=headers, cookies=page.cookies) as other:
        assert_problem(other.delete("/v1/clips/nope"), 403, "forbidden")
        assert_problem(_sign_in(other, secrets[WRITE]), 403, "forbidden")
        if headers:
            assert_problem(other.get("/v1/clips"), 403, "forbidden")


def test_a_key_in_a_header_counts_before_the_cookie(page: httpx2.Client, locked: Locked) -> None:
    _sign_in(page, locked[1][WRITE])
    wrong = page.get("/v1/clips", headers={"X-API-Key": "wrong"})
    assert_problem(wrong, 401, "unauthorized")


def test_pages_need_no_key(page: httpx2.Client) -> None:
    assert page.get("/").status_code in {200, 404}
    assert "text/html" in page.get("/").headers["content-type"]


def test_where_no_key_is_asked_for_nobody_signs_in(idle_service: Live) -> None:
    with idle_service.client(headers={"Origin": idle_service.url}) as client:
        assert client.get("/v1/session").json() == _session(None, keys_needed=False)
        assert_problem(_sign_in(client, "kx_a_b"), 401, "unauthorized")
        client.cookies.set(COOKIE, "of an earlier run")
        assert client.get("/v1/clips").status_code == 200


def test_an_empty_key_is_enough_where_no_keys_are_needed(
    idle_service: Live, page: httpx2.Client
) -> None:
    with idle_service.client(headers={"Origin": idle_service.url}) as client:
        answer = _sign_in(client, "")
        assert answer.json() == _session(None, keys_needed=False)
        assert "set-cookie" not in answer.headers
    assert_problem(_sign_in(page, ""), 401, "unauthorized")


def test_who_is_signed_in_stays_so_after_a_restart(tmp_path: Path) -> None:
    with serve(tmp_path / "data", require_keys=True) as live:
        store = _store(live.data_dir)
        with store.write() as tx:
            made = keys.create(tx, READ, "read")
        store.close()
        with live.client(headers={"Origin": live.url}) as page:
            token = _sign_in(page, made.secret).cookies[COOKIE]
    with serve(tmp_path / "data", require_keys=True) as live:
        headers = {"Origin": live.url, "Cookie": f"{COOKIE}={token}"}
        with live.client(headers=headers) as page:
            assert page.get("/v1/session").json() == _session("read", keys_needed=True)
    stored = [path.read_bytes() for path in live.data_dir.glob("*.sqlite3*")]
    assert not any(token.encode() in content for content in stored)
