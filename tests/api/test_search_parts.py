"""Searches by several parts over HTTP."""

from __future__ import annotations

import json
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip
from tests.api.conftest import assert_problem
from tests.api.test_clips import CLIP_FIELDS

LIKE = {"clip_id": "WALK"}


@pytest.fixture
def kick(demo: httpx2.Client) -> dict[str, Any]:
    clip: dict[str, Any] = demo.get("/v1/clips", params={"task": "kick"}).json()["items"][0]
    return clip


def _search(client: httpx2.Client, **body: Any) -> dict[str, Any]:
    answer = client.post("/v1/search", json=body)
    assert answer.status_code == 200, answer.text
    reply: dict[str, Any] = answer.json()
    return reply


def test_hits_have_their_shape_and_say_what_each_part_contributed(
    demo: httpx2.Client, walk: dict[str, Any], kick: dict[str, Any]
) -> None:
    examples = [
        {"clip_id": walk["id"], "start": 0.2, "end": 1.5, "weight": 2},
        {"clip_id": kick["id"], "against": True},
    ]
    reply = _search(demo, examples=examples, words=["walk", "zzyzx"], limit=3)
    assert set(reply) == {
        "method",
        "took_ms",
        "library_version",
        "items",
        "next",
        "facets",
        "unknown_words",
        "confidence",
        "expanded",
    }
    assert (reply["method"], reply["unknown_words"]) == ("fused", ["zzyzx"])
    assert [hit["rank"] for hit in reply["items"]] == [1, 2, 3]
    for hit in reply["items"]:
        assert set(hit) == {"rank", "score", "distance", "start", "end", "clip", "parts", "group"}
        assert set(hit["clip"]) == CLIP_FIELDS
        assert [(part["part"], part["against"]) for part in hit["parts"]] == [
            ("examples.0", False),
            ("examples.1", True),
            ("words.0", False),
        ]
        assert all(0 <= part["score"] <= 1 for part in hit["parts"])
        costs = [part["cost"] for part in hit["parts"]]
        assert sum(costs) == pytest.approx(hit["distance"], abs=1e-6)
    assert reply["items"][0]["clip"]["task"] == "walk"


def test_one_part_has_the_order_of_its_own_search(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    def ids(reply: dict[str, Any]) -> list[str]:
        return [hit["clip"]["id"] for hit in reply["items"]]

    by_example = demo.post("/v1/search/motion", json={"clip_id": walk["id"], "limit": 100})
    example = [{"clip_id": walk["id"]}]
    assert ids(_search(demo, examples=example, limit=100)) == ids(by_example.json())
    words = ["walk", "-kick"]
    by_words = demo.post("/v1/search/words", json={"words": words, "limit": 100})
    assert ids(_search(demo, words=words, limit=100)) == ids(by_words.json())


def test_pages_fields_and_filters(
    demo: httpx2.Client, walk: dict[str, Any], kick: dict[str, Any]
) -> None:
    asked = {
        "examples": [{"clip_id": walk["id"]}, {"clip_id": kick["id"]}],
        "filter": {"task": ["walk", "kick"]},
    }
    whole = _search(demo, **asked, limit=100)
    first = _search(demo, **asked, limit=2)
    rest = _search(demo, **asked, limit=100, cursor=first["next"])
    assert first["items"] + rest["items"] == whole["items"]
    assert {hit["clip"]["task"] for hit in whole["items"]} == {"walk", "kick"}
    chosen = demo.post("/v1/search?fields=parts,clip.name", json=asked).json()
    assert {frozenset(hit) for hit in chosen["items"]} == {frozenset({"parts", "clip"})}


@pytest.mark.parametrize("words", ['["walk"]', "walk"])
def test_an_uploaded_file_is_one_more_example(
    demo: httpx2.Client, take: DemoClip, walk: dict[str, Any], kick: dict[str, Any], words: str
) -> None:
    examples = [{"clip_id": walk["id"]}, {"clip_id": kick["id"], "against": True}]
    form = {"examples": json.dumps(examples), "words": words, "limit": "1", "start": "0.2"}
    answer = demo.post("/v1/search", files={"file": ("q.bvh", take.content)}, data=form)
    assert answer.status_code == 200, answer.text
    (hit,) = answer.json()["items"]
    assert hit["clip"]["task"] == "walk"
    assert [part["part"] for part in hit["parts"]] == [
        "examples.0",
        "examples.1",
        "file",
        "words.0",
    ]


def test_hits_are_not_like_an_uploaded_file_that_is_against(
    demo: httpx2.Client, take: DemoClip, walk: dict[str, Any]
) -> None:
    """The task of the file is the best without it, and the last with it."""
    files = {"file": ("q.bvh", take.content)}
    asked = {"words": json.dumps([take.task, "kick"]), "limit": "100"}
    with_it, without = (
        demo.post("/v1/search", files=files, data={**asked, "against": against}).json()["items"]
        for against in ("true", "false")
    )
    assert without[0]["clip"]["task"] == take.task
    assert with_it[0]["clip"]["task"] == "kick"
    assert with_it[0]["parts"][0]["against"] is True
    alone = demo.post("/v1/search", files=files, data={"against": "true"})
    assert alone.status_code == 422
    assert alone.headers["content-type"] == "application/problem+json"


@pytest.mark.parametrize(
    ("changes", "location"),
    [
        ({}, "body.examples"),
        ({"words": ["-walk"]}, "body.words"),
        ({"examples": [{"clip_id": "WALK", "against": True}]}, "body.examples"),
        ({"examples": [{"clip_id": "WALK", "weight": 0}]}, "body.examples.0.weight"),
        (
            {"examples": [{"clip_id": "WALK"}, {"clip_id": "WALK", "end": 1e5}]},
            "body.examples.1.end",
        ),
        ({"examples": [{"clip_id": "WALK", "scope": "windows"}]}, "body.examples.0.scope"),
        ({"words": ["walk"], "method": "nearest"}, "body.method"),
    ],
)
def test_what_is_wrong_is_named(
    demo: httpx2.Client, walk: dict[str, Any], changes: dict[str, Any], location: str
) -> None:
    body = json.loads(json.dumps(changes).replace("WALK", walk["id"]))
    answer = demo.post("/v1/search", json=body)
    assert_problem(answer, 422, "bad_field", location)


def test_an_unknown_clip_and_a_form_that_is_no_json(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    examples = [{"clip_id": walk["id"]}, {"clip_id": "nope"}]
    answer = demo.post("/v1/search", json={"examples": examples})
    assert_problem(answer, 404, "clip_not_found")
    deep = "[" * 30_000
    for form in ({"examples": "{"}, {"words": "[walk"}, {"words": deep}, {"examples": deep}):
        answer = demo.post("/v1/search", data=form, files={"none": ("", b"")})
        assert_problem(answer, 422, "bad_field", f"body.{next(iter(form))}")


def test_hits_are_grouped_and_counted(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    body = {"examples": [{"clip_id": walk["id"]}], "limit": 100, "include_self": True}
    asked = {**body, "group_by": "person", "facets": ["task", "word", "duration"]}
    reply = _search(demo, **asked)
    groups = [hit["group"] for hit in reply["items"]]
    assert len({group["value"] for group in groups}) == len(groups)
    total = sum(group["count"] for group in groups)
    facet = reply["facets"]["task"]
    assert sum(one["count"] for one in facet["values"]) + facet["missing"] == total
    assert len(reply["facets"]["duration"]["quartiles"]) == 5
    one = _search(demo, **body, group_by="person", group=groups[0]["value"])
    assert len(one["items"]) == groups[0]["count"]
    assert {hit["clip"]["person"] for hit in one["items"]} == {groups[0]["value"]}
    answer = demo.post("/v1/search", json={**body, "facets": ["persons"]})
    assert_problem(answer, 422, "bad_field", "body.facets")
