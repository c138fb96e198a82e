"""`Idempotency-Key`: repeated calls take effect once and get the first answer."""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx2
import pytest
from hypothesis import given
from hypothesis import strategies as st
from starlette.datastructures import Headers

from app.api.guard.content import ContentDigest
from app.demo import DemoClip
from app.store.key_role import KeyRole
from tests.api.conftest import assert_problem
from tests.api.test_service import _make_keys
from tests.live import Live, serve


@pytest.fixture(scope="module")
def own(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    with serve(tmp_path_factory.mktemp("keys") / "data") as live:
        yield live


@pytest.fixture
def client(own: Live) -> Iterator[httpx2.Client]:
    with own.client() as client:
        yield client


def create(client: httpx2.Client, key: str, url: str = "https://example.com/") -> httpx2.Response:
    new = {"url": url, "enabled": False}
    return client.post("/v1/webhooks", json=new, headers={"Idempotency-Key": key})


def count(client: httpx2.Client) -> int:
    return len(client.get("/v1/webhooks").json()["items"])


def test_a_repeated_call_takes_effect_once(client: httpx2.Client) -> None:
    before = count(client)
    first, second = create(client, "once"), create(client, "once")
    assert (first.status_code, second.status_code) == (201, 201)
    assert second.json() == first.json()
    assert second.headers["content-type"] == first.headers["content-type"]
    assert second.headers["idempotency-replayed"] == "true"
    assert "idempotency-replayed" not in first.headers
    assert count(client) == before + 1
    assert create(client, "twice").json()["id"] != first.json()["id"]


def test_a_key_belongs_to_its_path_and_its_body(client: httpx2.Client) -> None:
    webhook = create(client, "body").json()
    other = create(client, "body", "https://other.example/")
    assert_problem(other, 422, "idempotency_key_reused", "header.Idempotency-Key")
    path = f"/v1/webhooks/{webhook['id']}/test"
    tested = client.post(path, headers={"Idempotency-Key": "body"})
    assert (tested.status_code, tested.json()["pending"]) == (202, 1)
    again = client.post(path, headers={"Idempotency-Key": "body"})
    assert again.json()["pending"] == 1


def test_a_call_that_failed_can_be_made_again(client: httpx2.Client) -> None:
    assert create(client, "failed", "http://example.com/").status_code == 422
    assert create(client, "failed").status_code == 201


def test_calls_at_the_same_time_take_effect_once(own: Live, client: httpx2.Client) -> None:
    before = count(client)

    def call(_: int) -> httpx2.Response:
        with own.client() as one:
            return create(one, "together")

    with ThreadPoolExecutor(8) as threads:
        answers = list(threads.map(call, range(16)))
    assert count(client) == before + 1
    assert {answer.status_code for answer in answers} <= {201, 409}
    for answer in answers:
        if answer.status_code == 409:
            assert_problem(answer, 409, "call_in_progress")
            assert answer.headers["retry-after"] == "1"


def test_an_upload_that_is_sent_again_has_the_same_content(
    client: httpx2.Client, take: DemoClip
) -> None:
    """Each time, the client chooses another boundary between the fields of the form."""

    def upload(task: str) -> httpx2.Response:
        return client.post(
            "/v1/clips",
            files={"file": (take.path, take.content)},
            data={"task": task},
            headers={"Idempotency-Key": "upload"},
        )

    first, second = upload("walk"), upload("walk")
    assert (first.status_code, second.status_code) == (202, 202)
    assert second.json() == first.json()
    assert_problem(upload("run"), 422, "idempotency_key_reused")


@pytest.mark.parametrize("key", ["", "a b", "ü", "x" * 256])
def test_a_malformed_key_is_refused(client: httpx2.Client, key: str) -> None:
    answer = client.post("/v1/models/fit", headers={"Idempotency-Key": key.encode()})
    assert_problem(answer, 422, "bad_field", "header.Idempotency-Key")


def test_a_key_belongs_to_its_caller_and_searches_need_none(own: Live, tmp_path: Any) -> None:
    with serve(tmp_path / "data") as live:
        secrets = _make_keys(live.data_dir)
        jobs = set()
        for role in (KeyRole.WRITE, KeyRole.ADMIN):
            headers = {"X-API-Key": secrets[role], "Idempotency-Key": "same"}
            with live.client(headers=headers) as client:
                answer = client.post("/v1/models/fit")
                assert "idempotency-replayed" not in answer.headers
                jobs.add(client.post("/v1/models/fit").json()["job"]["id"])
                for words in (["a"], ["b"]):
                    found = client.post("/v1/search/words", json={"words": words})
                    assert found.status_code == 409
                    assert found.json()["code"] == "model_not_fitted"
        with live.client(headers={"Idempotency-Key": "same"}) as nobody:
            assert nobody.post("/v1/models/fit").status_code == 401


def test_the_description_names_the_header(client: httpx2.Client) -> None:
    for path, item in client.get("/openapi.json").json()["paths"].items():
        for method, operation in item.items():
            names = {parameter["name"] for parameter in operation.get("parameters", [])}
            reading = "search" in path or path in ("/v1/recognize", "/v1/session")
            changes = method == "post" and not reading
            assert ("Idempotency-Key" in names) == changes, (method, path)


BOUNDARIES = st.text("ab-", min_size=1, max_size=6)


def digest(body: bytes, boundary: str, cuts: list[int]) -> str:
    kind = f'multipart/form-data; boundary="{boundary}"'
    made = ContentDigest(Headers({"content-type": kind}))
    places = sorted({min(cut, len(body)) for cut in cuts} | {0, len(body)})
    for start, end in itertools.pairwise(places):
        made.update(body[start:end])
    return made.hexdigest()


@given(BOUNDARIES, st.lists(st.text("ab-x\n")), st.lists(st.integers(0, 40)))
def test_the_digest_does_not_depend_on_the_pieces(
    boundary: str, fields: list[str], cuts: list[int]
) -> None:
    body = boundary.join(["", *fields, ""]).encode()
    assert digest(body, boundary, cuts) == digest(body, boundary, [])


@given(st.lists(st.text("xyz\n"), min_size=1), st.lists(st.text("xyz\n"), min_size=1))
def test_the_digest_depends_on_the_fields_and_not_on_the_boundary(
    fields: list[str], others: list[str]
) -> None:
    first = digest("aaa".join(["", *fields, ""]).encode(), "aaa", [])
    second = digest("bb-b".join(["", *others, ""]).encode(), "bb-b", [])
    assert (first == second) == (fields == others)
