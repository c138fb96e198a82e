"""Near-duplicates and outliers over HTTP, from the demo service, and the policy on licenses."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from tests.api.conftest import assert_problem
from tests.live import wait_until


@pytest.fixture
def copied(demo: httpx2.Client, walk: dict[str, Any]) -> Any:
    """The id of a copy of a walk in another format, which is removed after the test."""
    content = demo.get(f"/v1/clips/{walk['id']}/export", params={"format": "glb"}).content
    created = demo.post("/v1/clips", files={"file": ("copy.glb", content)}).json()["clip"]["id"]
    wait_until(lambda: demo.get(f"/v1/clips/{created}").json()["state"] == "ready", 120)
    wait_until(lambda: demo.get("/v1/duplicates").json()["pending"] == 0, 120)
    yield created
    demo.delete(f"/v1/clips/{created}")


def test_a_copy_is_found_and_can_be_dismissed(
    demo: httpx2.Client, walk: dict[str, Any], copied: str
) -> None:
    def groups() -> list[dict[str, Any]]:
        found = demo.get("/v1/duplicates", params={"limit": 1000}).json()["items"]
        return [group for group in found if copied in {clip["id"] for clip in group["clips"]}]

    (group,) = groups()
    assert {clip["id"] for clip in group["clips"]} >= {walk["id"], copied}
    assert group["keeper"] == group["clips"][0]["id"]
    (pair,) = (p for p in group["pairs"] if {p["clip_id"], p["other_id"]} == {walk["id"], copied})
    assert (pair["kind"], pair["is_mirrored"]) == ("format", False)
    assert pair["distance"] < 0.05
    only_cuts = demo.get("/v1/duplicates", params={"kind": "cut", "limit": 1000}).json()["items"]
    assert all(p["kind"] == "cut" for one in only_cuts for p in one["pairs"])
    assert demo.post(f"/v1/duplicates/{group['id']}/dismiss").status_code == 204
    assert groups() == []
    answer = demo.post(f"/v1/duplicates/{group['id']}/dismiss")
    assert_problem(answer, 404, "not_found", "path.group_id")


def test_outliers_are_listed_accepted_and_dismissed(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    found = demo.get("/v1/outliers", params={"limit": 1000}).json()["items"]
    assert [one["score"] for one in found] == sorted((o["score"] for o in found), reverse=True)
    assert all(one["task"] == one["clip"]["task"] for one in found)
    path = f"/v1/outliers/{walk['id']}"
    try:
        assert demo.post(f"{path}/dismiss", json={"reason": "far"}).status_code == 204
        accepted = demo.post(f"{path}/accept", json={"reason": "far", "task": "stroll"})
        assert accepted.json()["task"] == "stroll"
    finally:
        demo.patch(f"/v1/clips/{walk['id']}", json={"task": "walk"})
    answer = demo.post(f"{path}/accept", json={"reason": "far"})
    assert_problem(answer, 404, "not_found", "path.clip_id")
    answer = demo.post(f"{path}/dismiss", json={"reason": "odd"})
    assert_problem(answer, 422, "bad_field", "body.reason")


def test_wrong_questions_are_refused(demo: httpx2.Client) -> None:
    answer = demo.get("/v1/duplicates", params={"threshold": 2})
    assert_problem(answer, 422, "bad_field", "query.threshold")
    answer = demo.get("/v1/duplicates", params={"cursor": "bad"})
    assert_problem(answer, 404, "page_not_found")
