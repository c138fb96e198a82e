"""Why a clip is a hit, over HTTP."""

from __future__ import annotations

import json
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip
from app.motion.roles.joint_roles import SUN_ROLES
from tests.api.conftest import assert_problem


def _first(client: httpx2.Client, **body: Any) -> dict[str, Any]:
    hit: dict[str, Any] = client.post("/v1/search", json=body).json()["items"][0]
    return hit


def test_each_part_says_when_and_where_it_is_like_the_hit(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    query = {"examples": [{"clip_id": walk["id"], "weight": 2}], "words": ["walk", "-kick"]}
    hit = _first(demo, **query)
    why = demo.post("/v1/search/why", json={**query, "hit": hit["clip"]["id"]}).json()
    assert (why["method"], why["rank"]) == ("fused", 1)
    assert why["score"] == pytest.approx(hit["score"])
    example, *words = why["parts"]
    assert [(one["part"], one["against"]) for one in why["parts"]] == [
        ("examples.0", False),
        ("words.0", False),
        ("words.1", True),
    ]
    for one, shown in zip(why["parts"], hit["parts"], strict=True):
        assert one["score"] == pytest.approx(shown["score"])
        assert one["cost"] == pytest.approx(shown["cost"], abs=1e-9)
    aligned = example["alignment"]
    assert aligned["joints"] == [role.value for role in SUN_ROLES]
    assert len(aligned["path"]) == len(aligned["differences"])
    assert aligned["seconds"] == [0.1, 0.1]
    assert example["weight"] == 2
    for one in words:
        assert one["alignment"] is None
        assert len(one["curve"]["times"]) == len(one["curve"]["values"])
        assert one["weight"] == 0.5
    assert max(words[0]["curve"]["values"]) > max(words[1]["curve"]["values"])


def test_an_uploaded_example_is_explained(demo: httpx2.Client, take: DemoClip) -> None:
    files = {"file": (take.path, take.content)}
    words = json.dumps(["walk"])
    found = demo.post("/v1/search", files=files, data={"words": words}).json()["items"][0]
    data = {"words": words, "hit": found["clip"]["id"]}
    why = demo.post("/v1/search/why", files=files, data=data).json()
    assert [one["part"] for one in why["parts"]] == ["file", "words.0"]
    assert why["rank"] == 1
    assert why["parts"][0]["alignment"]["path"][-1][1] == pytest.approx(found["end"], abs=0.5)


def test_a_clip_that_the_filter_leaves_out_has_no_rank(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    query = {"examples": [{"clip_id": walk["id"]}], "filter": {"task": "kick"}}
    why = demo.post("/v1/search/why", json={**query, "hit": walk["id"]}).json()
    assert why["rank"] is None
    assert why["score"] > 0.99
    aligned = why["parts"][0]["alignment"]
    assert max(aligned["mean_differences"]) == 0


def test_wrong_calls_are_problems(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    query: dict[str, Any] = {"examples": [{"clip_id": walk["id"]}]}
    path = "/v1/search/why"
    assert_problem(demo.post(path, json=query), 422, "bad_field", "body.hit")
    unknown = demo.post(path, json={**query, "hit": "clip_none"})
    assert_problem(unknown, 404, "clip_not_found")
    left_out = {"words": ["kick", "-walk"], "hit": walk["id"]}
    assert_problem(demo.post(path, json=left_out), 422, "bad_field", "body.hit")


def test_poses_and_a_rhythm_say_when_and_how_fast(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    poses = [{"clip_id": walk["id"], "time": 1.0}, {"clip_id": walk["id"], "time": 0.2}]
    query: dict[str, Any] = {
        "poses": {"sequence": poses[::-1], "weight": 2},
        "rhythm": {"cycles_per_minute": 55, "tolerance": 0.3},
        "examples": [{"clip_id": walk["id"], "body_part": "legs"}],
        "include_self": True,
    }
    hit = _first(demo, **query)
    assert [part["part"] for part in hit["parts"]] == ["examples.0", "poses", "rhythm"]
    why = demo.post("/v1/search/why", json={**query, "hit": walk["id"]}).json()
    example, in_order, rhythm = why["parts"]
    assert example["alignment"] is not None
    assert [moment["time"] for moment in in_order["poses"]] == pytest.approx([0.2, 1.0], abs=0.1)
    assert max(moment["distance"] for moment in in_order["poses"]) < 0.01
    assert in_order["weight"] == 2
    assert 20 < rhythm["cycles_per_minute"] < 200
