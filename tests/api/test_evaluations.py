"""Evaluations: started, judged by a worker, listed, compared, canceled, deleted, and refused."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from tests.api.conftest import assert_problem
from tests.live import Live

PATH = "/v1/evaluations"


@pytest.fixture(scope="module")
def judged(demo_service: Live) -> list[dict[str, Any]]:
    """Two evaluations of the kind symbols, the older one first."""
    return [judge(demo_service, {"kind": "symbols"}) for _ in range(2)]


def judge(service: Live, body: dict[str, Any]) -> dict[str, Any]:
    """Start an evaluation, wait for its end, and return it."""
    with service.client() as client:
        answer = client.post(PATH, json=body)
        assert answer.status_code == 202, answer.text
        job = service.wait_for_job(answer.json()["job"]["id"])
        assert job["state"] == "succeeded", job["error"]
        found: dict[str, Any] = client.get(f"{PATH}/{job['result']['evaluation_id']}").json()
        return found


def test_a_result_says_what_was_judged_and_when(
    demo: httpx2.Client, judged: list[dict[str, Any]]
) -> None:
    found = judged[0]
    assert (found["kind"], found["options"], found["library_size"]) == ("symbols", {}, 12)
    version = demo.get("/v1/status").json()["library_version"]
    assert 0 < found["library_version"] <= version
    assert found["document"]["symbols"] == 12
    assert found["figures"][0]["value"] == found["document"]["placing_error"]


def test_a_result_is_compared_with_the_one_before_it(judged: list[dict[str, Any]]) -> None:
    older, newer = judged
    assert newer["previous"]["id"] == older["id"]
    assert newer["previous"]["figures"] == newer["figures"]  # the library is the same
    assert "document" not in newer["previous"]


def test_results_are_listed_newest_first_in_pages(
    demo: httpx2.Client, judged: list[dict[str, Any]]
) -> None:
    query = {"kind": "symbols", "limit": 1}
    first = demo.get(PATH, params=query).json()
    second = demo.get(PATH, params={**query, "cursor": first["next"]}).json()
    ids = [page["items"][0]["id"] for page in (first, second)]
    assert ids == [judged[1]["id"], judged[0]["id"]]
    assert first["total"] == 2
    assert "document" not in first["items"][0]


def test_options_change_what_is_judged(demo_service: Live) -> None:
    body = {
        "kind": "retrieval",
        "methods": ["vector"],
        "filter": {"task": ["walk", "kick"]},
        "by": "task",
        "k": 3,
    }
    found = judge(demo_service, body)
    assert found["options"] == {name: value for name, value in body.items() if name != "kind"}
    assert found["library_size"] == 8
    assert found["document"]["confusion"]["classes"] == ["kick", "walk"]
    assert found["document"]["confusion"]["k"] == 3
    assert set(found["document"]["by_group"]["vector"]) == {"kick", "walk"}
    assert {row["name"] for row in found["figures"]} == {"nearest clip, vector", "MAP, vector"}


def test_too_few_labels_are_the_reason_of_a_failed_job(
    demo: httpx2.Client, demo_service: Live
) -> None:
    job = demo.post(PATH, json={"kind": "keyposes"}).json()["job"]
    ended = demo_service.wait_for_job(job["id"])
    assert ended["state"] == "failed"
    assert ended["error"]["code"] == "not_enough_labels"
    assert demo.get(PATH, params={"kind": "keyposes"}).json()["total"] == 0


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ({"kind": "karate"}, "body.kind"),
        ({}, "body.kind"),
        ({"kind": "symbols", "k": 3}, "body.k"),
        ({"kind": "retrieval", "k": 0}, "body.k"),
        ({"kind": "retrieval", "methods": ["default"]}, "body.methods"),
        ({"kind": "recognition", "methods": ["vector"]}, "body.methods"),
        ({"kind": "recognition", "false_accept_rate": 1}, "body.false_accept_rate"),
        ({"kind": "keyposes", "tolerance": 0}, "body.tolerance"),
        ({"kind": "keyposes", "by": "age"}, "body.by"),
        ({"kind": "words", "filter": {"color": "red"}}, "body.filter.color"),
    ],
)
def test_wrong_options_are_refused_with_their_place(
    idle: httpx2.Client, body: dict[str, Any], place: str
) -> None:
    assert_problem(idle.post(PATH, json=body), 422, "bad_field", place)


def test_equal_requests_wait_once_and_can_be_canceled(idle: httpx2.Client) -> None:
    jobs = [idle.post(PATH, json={"kind": "words"}).json()["job"] for _ in range(2)]
    assert jobs[0]["id"] == jobs[1]["id"]
    assert jobs[0]["kind"] == "evaluate"
    canceled = idle.delete(f"/v1/jobs/{jobs[0]['id']}").json()
    assert canceled["state"] == "canceled"


def test_a_deleted_result_is_gone(demo: httpx2.Client, demo_service: Live) -> None:
    made = judge(demo_service, {"kind": "low-dimensional"})
    assert made["figures"][0]["unit"] == "mm"
    assert demo.delete(f"{PATH}/{made['id']}").status_code == 204
    for method in ("GET", "DELETE"):
        answer = demo.request(method, f"{PATH}/{made['id']}")
        assert_problem(answer, 404, "evaluation_not_found")
