"""Measures of clips over HTTP: shown, filtered, sorted, on the map; and sources and licenses."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from app.store.clips.measures import MEASURES
from tests.api.conftest import assert_problem


@pytest.fixture
def clips(demo: httpx2.Client) -> list[dict[str, Any]]:
    asked = {"state": "ready", "limit": 1000}
    items: list[dict[str, Any]] = demo.get("/v1/clips", params=asked).json()["items"]
    return items


def test_a_walk_goes_farther_than_a_wave(clips: list[dict[str, Any]]) -> None:
    walks, waves = (
        [one for one in clips if one["task"] == task and one["speed"] is not None]
        for task in ("walk", "wave")
    )
    assert min(one["speed"] for one in walks) > 0.5 > max(one["speed"] for one in waves)
    for one in walks:
        assert one["travel"] == pytest.approx(one["speed"] * one["duration"], rel=0.1)
        assert one["energy"] > 0


@pytest.mark.parametrize("name", MEASURES)
def test_lists_are_filtered_and_sorted_by_every_measure(
    demo: httpx2.Client, clips: list[dict[str, Any]], name: str
) -> None:
    known = sorted(one[name] for one in clips if one[name] is not None)
    middle = known[len(known) // 2] if known else 1.0
    asked = {f"min_{name}": middle, "sort": f"-{name}", "limit": 1000}
    found = [one[name] for one in demo.get("/v1/clips", params=asked).json()["items"]]
    assert found == sorted((value for value in known if value >= middle), reverse=True)
    below = demo.get("/v1/clips", params={f"max_{name}": middle, "limit": 1000}).json()
    assert all(one[name] <= middle for one in below["items"])
    assert below["total"] == len([value for value in known if value <= middle])


def test_searches_and_the_map_are_filtered_by_measures(
    demo: httpx2.Client, clips: list[dict[str, Any]]
) -> None:
    fast = {one["id"] for one in clips if (one["speed"] or 0) >= 0.5}
    asked = {"clip_id": clips[0]["id"], "limit": 100, "filter": {"min_speed": 0.5}}
    hits = demo.post("/v1/search/motion", json=asked).json()["items"]
    assert hits
    assert {hit["clip"]["id"] for hit in hits} <= fast
    points = demo.get("/v1/space", params={"space": "vectors", "min_speed": 0.5}).json()["items"]
    assert {point["clip_id"] for point in points} == fast
    by_id = {one["id"]: one for one in clips}
    for point in points:
        assert {name: point[name] for name in MEASURES} == {
            name: by_id[point["clip_id"]][name] for name in MEASURES
        }


def test_wrong_bounds_are_named(demo: httpx2.Client) -> None:
    answer = demo.get("/v1/clips", params={"min_speed": "fast"})
    assert_problem(answer, 422, "bad_field", "query.min_speed")
    answer = demo.get("/v1/clips", params={"sort": "height"})
    assert_problem(answer, 422, "bad_field", "query.sort")


def test_sources_and_licenses_are_counted(demo: httpx2.Client, clips: list[dict[str, Any]]) -> None:
    for clip in clips[:2]:
        named = {"source": "lab 7", "license": "CC-BY-4.0"}
        assert demo.patch(f"/v1/clips/{clip['id']}", json=named).status_code == 200
    try:
        for path, name in (("/v1/sources", "lab 7"), ("/v1/licenses", "CC-BY-4.0")):
            found = {one["name"]: one["count"] for one in demo.get(path).json()["items"]}
            assert found[name] == 2
    finally:
        for clip in clips[:2]:
            before = {name: clip[name] for name in ("source", "license")}
            demo.patch(f"/v1/clips/{clip['id']}", json=before)
