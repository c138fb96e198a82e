"""Searches by pose over HTTP."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from app.api.schemas.pose import A_POSE
from tests.api.conftest import assert_problem
from tests.api.test_clips import CLIP_FIELDS


def _search(client: httpx2.Client, **body: Any) -> dict[str, Any]:
    answer = client.post("/v1/search/pose", json=body)
    assert answer.status_code == 200, answer.text
    reply: dict[str, Any] = answer.json()
    return reply


def test_hits_have_their_shape_and_a_time(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = _search(demo, clip_id=walk["id"], time=0.5, limit=5)
    assert set(reply) == {"method", "took_ms", "library_version", "items", "next"}
    assert reply["method"] == "pose"
    assert [hit["rank"] for hit in reply["items"]] == [1, 2, 3, 4, 5]
    for hit in reply["items"]:
        assert set(hit) == {"rank", "score", "distance", "start", "end", "time", "clip"}
        assert set(hit["clip"]) == CLIP_FIELDS
        assert 0 <= hit["start"] <= hit["time"] < hit["end"] <= hit["clip"]["duration"]
        assert hit["clip"]["id"] != walk["id"]
    assert reply["items"][0]["clip"]["task"] == "walk"


def test_thirteen_positions(demo: httpx2.Client) -> None:
    reply = _search(demo, positions=A_POSE, filter={"task": "wave"}, limit=3)
    assert {hit["clip"]["task"] for hit in reply["items"]} == {"wave"}


def test_the_pose_of_an_uploaded_file(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    content = demo.get(f"/v1/clips/{walk['id']}/file").content
    form = {"time": "0.5", "limit": "3", "filter": '{"task": "walk"}'}
    answer = demo.post("/v1/search/pose", data=form, files={"file": ("walk.bvh", content)})
    assert answer.status_code == 200, answer.text
    stored = _search(demo, clip_id=walk["id"], time=0.5, limit=3, filter={"task": "walk"})
    assert [hit["clip"]["id"] for hit in answer.json()["items"]] == [
        hit["clip"]["id"] for hit in stored["items"]
    ]
    itself = form | {"include_self": "true"}
    hits = demo.post("/v1/search/pose", data=itself, files={"file": ("walk.bvh", content)}).json()
    assert hits["items"][0]["clip"]["id"] == walk["id"]


@pytest.mark.parametrize(
    ("form", "has_file", "location"),
    [
        ({}, True, "body.time"),
        ({"time": "99"}, True, "body.time"),
        ({"time": "0.5"}, False, "body.file"),
        ({"time": "0.5", "clip_id": "clip_x"}, True, "body.clip_id"),
        ({"time": "0.5", "positions": "[]"}, True, "body.positions"),
    ],
)
def test_wrong_fields_of_a_form_are_named(
    demo: httpx2.Client,
    walk: dict[str, Any],
    form: dict[str, str],
    has_file: bool,
    location: str,
) -> None:
    content = demo.get(f"/v1/clips/{walk['id']}/file").content
    files = {"file" if has_file else "skeleton": ("walk.bvh", content)}
    answer = demo.post("/v1/search/pose", data=form, files=files)
    assert_problem(answer, 422, "bad_field", location)


def test_all_times_of_a_pose_come_page_by_page(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    asked = {"clip_id": walk["id"], "time": 0.5, "places": "all", "include_self": True}
    whole = _search(demo, **asked, limit=1000)
    ids = [hit["clip"]["id"] for hit in whole["items"]]
    assert ids.count(walk["id"]) > 1
    assert whole["items"][0]["distance"] == 0
    first = _search(demo, **asked, limit=7)
    second = _search(demo, **asked, limit=7, cursor=first["next"])
    together = first["items"] + second["items"]
    assert [h["distance"] for h in together] == [h["distance"] for h in whole["items"][:14]]


@pytest.mark.parametrize(
    ("body", "location"),
    [
        ({}, "body.positions"),
        ({"clip_id": "CLIP"}, "body.time"),
        ({"clip_id": "CLIP", "time": 1e5}, "body.time"),
        ({"clip_id": "CLIP", "time": "soon"}, "body.time"),
        ({"clip_id": "CLIP", "time": 0.1, "positions": A_POSE}, "body.clip_id"),
        ({"positions": A_POSE[:12]}, "body.positions"),
        ({"positions": [*A_POSE[:12], [0, None, 0]]}, "body.positions.12"),
        ({"positions": [[0, 0, 0]] * 13}, "body.positions"),
        ({"positions": "here"}, "body.positions"),
        ({"positions": A_POSE, "places": "some"}, "body.places"),
        ({"positions": A_POSE, "limit": 1001}, "body.limit"),
        ({"positions": A_POSE, "pose": 1}, "body.pose"),
    ],
)
def test_wrong_fields_are_named(
    demo: httpx2.Client, walk: dict[str, Any], body: dict[str, Any], location: str
) -> None:
    asked = body | ({"clip_id": walk["id"]} if "clip_id" in body else {})
    answer = demo.post("/v1/search/pose", json=asked)
    assert_problem(answer, 422, "bad_field", location)


def test_a_number_that_json_does_not_have(demo: httpx2.Client) -> None:
    body = '{"positions": [' + ",".join(["[1e999, 0, 0]"] * 13) + "]}"
    answer = demo.post(
        "/v1/search/pose", content=body, headers={"content-type": "application/json"}
    )
    assert answer.status_code == 422
    assert "left_knee" in answer.json()["errors"][0]["message"]


def test_an_unknown_clip_is_not_found(demo: httpx2.Client) -> None:
    answer = demo.post("/v1/search/pose", json={"clip_id": "nobody", "time": 0})
    assert_problem(answer, 404, "clip_not_found")
