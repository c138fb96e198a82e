"""Measures of clips over HTTP: shown, filtered, sorted, on the map; and sources and licenses."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest

from app.store.clips.measures import EVERY, MEASURES
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


def test_every_measure_has_a_unit_a_definition_and_deciles(
    demo: httpx2.Client, clips: list[dict[str, Any]]
) -> None:
    found = {one["name"]: one for one in demo.get("/v1/measures").json()["items"]}
    assert list(found) == list(EVERY)
    for one in found.values():
        assert one["definition"]
        if one["count"]:
            assert one["quantiles"] == sorted(one["quantiles"])
            assert (len(one["quantiles"]), sum(one["counts"])) == (11, one["count"])
    walks = demo.get("/v1/measures", params={"task": "walk"}).json()["items"]
    counted = {one["name"]: one["counts"] for one in walks}
    tasks = [one["task"] for one in clips]
    assert sum(counted["speed"]) == tasks.count("walk")
    assert sum(counted["speed"][:3]) == 0  # no walk is slow


def test_a_clip_shows_its_measures_beside_the_library(
    demo: httpx2.Client, clips: list[dict[str, Any]]
) -> None:
    summary = {one["name"]: one for one in demo.get("/v1/measures").json()["items"]}
    for clip in clips[:3]:
        answer = demo.get(f"/v1/clips/{clip['id']}")
        shown = answer.json()["measures"]
        assert list(shown) == list(EVERY)
        assert shown["speed"]["value"] == pytest.approx(clip["speed"])
        for name, one in shown.items():
            assert one["unit"] == summary[name]["unit"]
            if one["value"] is None:
                assert one["percentile"] is None
                continue
            least, most = summary[name]["quantiles"][0], summary[name]["quantiles"][-1]
            assert least - 1e-6 <= one["value"] <= most + 1e-6
            assert 0 <= one["percentile"] <= 100
        tag = {"If-None-Match": answer.headers["ETag"]}
        assert demo.get(f"/v1/clips/{clip['id']}", headers=tag).status_code == 304
        some = demo.get(f"/v1/clips/{clip['id']}", params={"fields": "id,measures"}).json()
        assert some == {"id": clip["id"], "measures": shown}


@pytest.mark.parametrize("name", ["foot_skate", "dominance", "loop_gap", "range_left_knee"])
def test_lists_and_searches_are_filtered_and_sorted_by_quality(
    demo: httpx2.Client, clips: list[dict[str, Any]], name: str
) -> None:
    summary = {one["name"]: one for one in demo.get("/v1/measures").json()["items"]}
    middle = summary[name]["quantiles"][5]
    asked = {f"measure.{name}.min": middle, "sort": f"-{name}", "limit": 1000}
    listed = demo.get("/v1/clips", params=asked).json()["items"]
    values = [
        demo.get(f"/v1/clips/{one['id']}", params={"fields": "measures"}).json()["measures"][name]
        for one in listed[:10]
    ]
    shown = [one["value"] for one in values]
    assert shown == sorted(shown, reverse=True)
    assert min(shown) >= middle
    bound = {f"measure.{name}.min": middle}
    hits = demo.post(
        "/v1/search/motion", json={"clip_id": clips[0]["id"], "limit": 1000, "filter": bound}
    ).json()["items"]
    found = {hit["clip"]["id"] for hit in hits}
    assert found | {clips[0]["id"]} == {one["id"] for one in listed} | {clips[0]["id"]}


def test_wrong_bounds_of_quality_are_named(demo: httpx2.Client) -> None:
    for asked in ({"measure.height.min": "1"}, {"measure.jitter": "1"}):
        answer = demo.get("/v1/clips", params=asked)
        assert_problem(answer, 422, "bad_field", f"query.filter.{next(iter(asked))}")
    answer = demo.get("/v1/clips", params={"measure.jitter.min": "much"})
    assert_problem(answer, 422, "bad_field", "query.filter.measure.jitter.min")
