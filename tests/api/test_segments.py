"""Segments over HTTP: listed, and searched."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from tests.api.conftest import assert_problem


@pytest.fixture
def wave(demo: httpx2.Client) -> dict[str, Any]:
    clip: dict[str, Any] = demo.get("/v1/clips", params={"task": "wave"}).json()["items"][0]
    return clip


def test_segments_are_listed_with_cycles(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    reply = demo.get(f"/v1/clips/{wave['id']}/segments").json()
    assert reply["next"] is None
    assert [one["index"] for one in reply["items"]] == list(range(len(reply["items"])))
    for one in reply["items"]:
        assert one["duration"] == pytest.approx(one["end"] - one["start"])
    assert len(reply["cycles"]) >= 2, "waving repeats itself"
    for cycle in reply["cycles"]:
        own = [one for one in reply["items"] if one["cycle"] == cycle["index"]]
        assert len(own) == cycle["segments"]
        assert own[0]["index"] == cycle["first"]


def test_a_segment_finds_others(demo: httpx2.Client, wave: dict[str, Any]) -> None:
    segments = demo.get(f"/v1/clips/{wave['id']}/segments").json()["items"]
    asked = {"clip_id": wave["id"], "segment": len(segments) // 2, "scope": "segments", "limit": 5}
    hits = demo.post("/v1/search/motion", json=asked).json()
    assert hits["method"] == "vector"
    assert hits["items"][0]["clip"]["task"] == "wave"
    assert all(hit["end"] > hit["start"] for hit in hits["items"])
    following = demo.post("/v1/search/motion", json=asked | {"cursor": hits["next"]}).json()
    assert [hit["rank"] for hit in following["items"]] == [6, 7, 8, 9, 10]
    whole = [(one["start"], one["end"]) for one in segments]
    own = [(h["start"], h["end"]) for h in hits["items"] if h["clip"]["id"] == wave["id"]]
    assert all(any(span == pytest.approx(one, abs=1e-4) for one in whole) for span in own)


@pytest.mark.parametrize(
    ("asked", "location"),
    [
        ({"segment": 10_000, "scope": "segments"}, "body.segment"),
        ({"segment": -1, "scope": "segments"}, "body.segment"),
        ({"segment": 0}, "body.segment"),
        ({"segment": 0, "scope": "segments", "method": "msv-dtw"}, "body.method"),
        ({"scope": "steps"}, "body.scope"),
    ],
)
def test_wrong_fields_are_named(
    demo: httpx2.Client, wave: dict[str, Any], asked: dict[str, Any], location: str
) -> None:
    answer = demo.post("/v1/search/motion", json={"clip_id": wave["id"], **asked})
    assert_problem(answer, 422, "bad_field", location)


def test_unknown_clips_are_not_found(demo: httpx2.Client) -> None:
    assert_problem(demo.get("/v1/clips/none/segments"), 404, "clip_not_found")
