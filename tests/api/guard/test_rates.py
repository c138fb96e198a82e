"""Too many calls, and too many wrong keys, are answered 429 for a while."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import httpx2
import pytest

from app.store.key_role import KeyRole
from tests.api.conftest import assert_problem
from tests.api.test_service import _make_keys
from tests.live import Live, serve

BURST = 40
Locked = tuple[Live, Live, dict[KeyRole, str]]


@pytest.fixture(scope="module")
def locked(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Locked]:
    """Two API processes on one library with keys, and a small limit."""
    data_dir = tmp_path_factory.mktemp("limited") / "data"
    limits = {"rate_limit_burst": BURST, "rate_limit_per_minute": 1, "trusted_proxies": "127.0.0.1"}
    with serve(data_dir, **limits) as first, serve(data_dir, **limits) as second:
        yield first, second, _make_keys(data_dir)


def _from(live: Live, address: str, key: str = "") -> httpx2.Client:
    headers = {"X-Forwarded-For": address} | ({"X-API-Key": key} if key else {})
    return live.client(headers=headers)


def test_processes_count_the_calls_of_a_key_together(locked: Locked) -> None:
    *both, secrets = locked
    statuses = []
    for number in range(BURST):
        with _from(both[number % 2], f"10.0.1.{number}", secrets[KeyRole.READ]) as client:
            answer = client.get("/v1/clips")
            statuses.append(answer.status_code)
            assert answer.headers["RateLimit"].startswith(f'"calls";r={BURST - 1 - number}')
            assert answer.headers["RateLimit-Policy"] == f'"calls";q={BURST};w={60 * BURST}'
    assert statuses == [200] * BURST
    for live in both:
        with _from(live, "10.0.1.200", secrets[KeyRole.READ]) as client:
            answer = client.get("/v1/clips")
            assert_problem(answer, 429, "rate_limited")
            assert 1 <= int(answer.headers["Retry-After"]) <= 60
            assert client.get("/livez").status_code == 200
            assert client.get("/readyz").status_code == 200
        with _from(live, "10.0.1.200", secrets[KeyRole.WRITE]) as client:
            assert client.get("/v1/clips").status_code == 200


def test_without_a_key_the_address_is_limited(locked: Locked) -> None:
    with _from(locked[0], "2001:db8::1") as client:
        statuses = [client.get("/openapi.json").status_code for _ in range(BURST + 1)]
    assert statuses == [200] * BURST + [429]
    with _from(locked[0], "2001:db8::2") as client:  # of the same network
        assert_problem(client.get("/v1/clips"), 429, "rate_limited")
    with _from(locked[0], "2001:db8:1::1") as client:
        assert_problem(client.get("/v1/clips"), 401, "unauthorized")


def test_guesses_of_keys_are_slowed(locked: Locked) -> None:
    *both, secrets = locked
    statuses = []
    for number in range(22):
        with _from(both[number % 2], "10.0.2.1", f"kx_a_{number}") as client:
            statuses.append(client.get("/v1/clips").status_code)
    assert statuses == [401] * 20 + [429] * 2
    with _from(both[0], "10.0.2.1", secrets[KeyRole.ADMIN]) as client:
        answer = client.get("/v1/clips")
        assert_problem(answer, 429, "rate_limited")
        assert 1 <= int(answer.headers["Retry-After"]) <= 6
    with _from(both[0], "10.0.2.2", secrets[KeyRole.ADMIN]) as client:
        assert client.get("/v1/clips").status_code == 200


def test_guesses_by_signing_in_are_slowed(locked: Locked) -> None:
    origin = {"Origin": locked[0].url}
    with _from(locked[0], "10.0.3.1") as client:
        sent = [{"key": f"kx_a_{number}"} for number in range(21)]
        answers = [client.post("/v1/session", json=one, headers=origin) for one in sent]
    assert [answer.status_code for answer in answers] == [401] * 20 + [429]
    assert_problem(answers[-1], 429, "rate_limited")


def test_one_wrong_key_again_and_again_locks_out_no_neighbor(locked: Locked) -> None:
    live, _, secrets = locked
    with _from(live, "10.0.4.1", "kx_revoked_long_ago") as client:
        statuses = [client.get("/v1/clips").status_code for _ in range(30)]
    assert statuses == [401] * 10 + [429] * 20
    with _from(live, "10.0.4.1", secrets[KeyRole.ADMIN]) as client:
        assert client.get("/v1/clips").status_code == 200


def test_where_no_keys_are_needed_nobody_is_limited(tmp_path: Path) -> None:
    limits = {"rate_limit_burst": 1, "rate_limit_per_minute": 1}
    with serve(tmp_path / "data", **limits) as live, live.client() as client:
        answers = [client.get("/v1/clips") for _ in range(5)]
        wrong = [client.get("/v1/clips", headers={"X-API-Key": "x"}) for _ in range(30)]
    assert {answer.status_code for answer in answers} == {200}
    assert {answer.status_code for answer in wrong} == {401}
    assert "RateLimit" not in answers[0].headers


def test_zero_is_no_limit(tmp_path: Path) -> None:
    with serve(tmp_path / "data", rate_limit_burst=1, rate_limit_per_minute=0) as live:
        key = _make_keys(live.data_dir)[KeyRole.READ]
        with live.client(headers={"X-API-Key": key}) as client:
            assert {client.get("/v1/clips").status_code for _ in range(5)} == {200}
