"""Pages of the origins in the settings may call the API; pages of other origins may not."""

from __future__ import annotations

from collections.abc import Iterator

import httpx2
import pytest

from tests.api.conftest import assert_problem
from tests.live import serve

VIEWER, OTHER = "https://viewer.example", "https://other.example"
ASKED = {"Access-Control-Request-Method": "POST"}


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx2.Client]:
    origins = f"{VIEWER}, http://localhost:5173"
    folder = tmp_path_factory.mktemp("cors") / "data"
    with serve(folder, cors_origins=origins) as live, live.client() as client:
        yield client


@pytest.mark.parametrize("origin", [VIEWER, "http://localhost:5173"])
def test_a_page_of_a_named_origin_may_call(client: httpx2.Client, origin: str) -> None:
    asked = {**ASKED, "Origin": origin, "Access-Control-Request-Headers": "x-api-key"}
    preflight = client.options("/v1/clips", headers=asked)
    assert preflight.status_code == 200
    assert preflight.headers["access-control-allow-origin"] == origin
    assert "X-API-Key" in preflight.headers["access-control-allow-headers"]
    assert "access-control-allow-credentials" not in preflight.headers
    page = {"Origin": origin, "Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "cors"}
    answer = client.get("/v1/clips", headers=page)
    assert answer.status_code == 200
    assert answer.headers["access-control-allow-origin"] == origin
    assert "ETag" in answer.headers["access-control-expose-headers"]
    refused = client.get("/v1/clips/nope", headers=page)
    assert_problem(refused, 404, "clip_not_found")
    assert refused.headers["access-control-allow-origin"] == origin
    assert client.delete("/v1/clips/nope", headers=page).status_code == 404


def test_a_page_of_another_origin_may_not_call(client: httpx2.Client) -> None:
    preflight = client.options("/v1/clips", headers={**ASKED, "Origin": OTHER})
    assert_problem(preflight, 403, "forbidden")
    assert "access-control-allow-origin" not in preflight.headers
    for headers in ({"Origin": OTHER}, {"Sec-Fetch-Site": "cross-site"}, {"Origin": "null"}):
        answer = client.get("/v1/clips", headers=headers)
        assert_problem(answer, 403, "forbidden")
        assert "access-control-allow-origin" not in answer.headers
    rebound = {"Origin": VIEWER, "Host": "rebound.example"}
    assert client.get("/v1/clips", headers=rebound).status_code == 403


def test_without_named_origins_no_page_may_call(idle: httpx2.Client) -> None:
    preflight = idle.options("/v1/clips", headers={**ASKED, "Origin": VIEWER})
    assert_problem(preflight, 403, "forbidden")
