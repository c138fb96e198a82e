"""Searches and recognition over HTTP."""

from __future__ import annotations

import json
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip
from tests.api.conftest import assert_problem
from tests.api.test_clips import CLIP_FIELDS

LEARNED = ["metric-task", "metric-person"]
METHODS = ["fused", "vector", "dtw", "msv-dtw", "msv-xcorr", *LEARNED]


def _search(client: httpx2.Client, **body: Any) -> dict[str, Any]:
    answer = client.post("/v1/search/motion", json=body)
    assert answer.status_code == 200, answer.text
    reply: dict[str, Any] = answer.json()
    return reply


@pytest.mark.parametrize("method", METHODS)
def test_hits_have_their_shape(demo: httpx2.Client, walk: dict[str, Any], method: str) -> None:
    reply = _search(demo, clip_id=walk["id"], method=method, limit=5)
    assert set(reply) == {"method", "took_ms", "library_version", "items", "next"}
    assert reply["method"] == method
    assert [hit["rank"] for hit in reply["items"]] == [1, 2, 3, 4, 5]
    for hit in reply["items"]:
        assert set(hit) == {"rank", "score", "distance", "start", "end", "clip"}
        assert set(hit["clip"]) == CLIP_FIELDS
        assert 0 <= hit["score"] <= 1
        assert hit["clip"]["id"] != walk["id"]
    distances = [hit["distance"] for hit in reply["items"]]
    assert distances == sorted(distances)


@pytest.mark.parametrize("method", METHODS)
def test_hits_within_a_distance(demo: httpx2.Client, walk: dict[str, Any], method: str) -> None:
    query = {"clip_id": walk["id"], "method": method}
    every = _search(demo, **query, limit=1000)["items"]
    limit = every[3]["distance"]
    near = [hit for hit in every if hit["distance"] <= limit]
    found = _search(demo, **query, limit=1000, max_distance=limit)
    assert found["items"] == near
    assert found["next"] is None
    page = _search(demo, **query, limit=2, max_distance=limit)
    assert page["items"] == near[:2]
    rest = _search(demo, **query, limit=1000, max_distance=limit, cursor=page["next"])
    assert rest["items"] == near[2:]
    assert _search(demo, **query, max_distance=0.0)["items"] == []


@pytest.mark.parametrize("scope", ["windows", "segments"])
def test_parts_within_a_distance(demo: httpx2.Client, walk: dict[str, Any], scope: str) -> None:
    query = {"clip_id": walk["id"], "start": 0.0, "end": 1.0, "scope": scope}
    every = _search(demo, **query, limit=10)["items"]
    found = _search(demo, **query, limit=10, max_distance=every[2]["distance"])
    assert found["items"] == [h for h in every if h["distance"] <= every[2]["distance"]]


@pytest.mark.parametrize(
    "options",
    [{"q": 1}, {"eta": 0.4}, {"q": 1, "eta": 0.4}, {"method": "msv-xcorr", "normalized": True}],
    ids=str,
)
def test_motion_volumes_of_other_settings(
    demo: httpx2.Client, walk: dict[str, Any], options: dict[str, Any]
) -> None:
    query = {"clip_id": walk["id"], "limit": 1000, "include_self": True, "method": "msv-dtw"}
    plain = _search(demo, **{**query, "method": options.get("method", "msv-dtw")})["items"]
    found = _search(demo, **{**query, **options})["items"]
    assert found[0]["clip"]["id"] == walk["id"]
    assert found[0]["distance"] < 1e-5
    assert {hit["clip"]["id"] for hit in found} == {hit["clip"]["id"] for hit in plain}
    assert [hit["distance"] for hit in found] != [hit["distance"] for hit in plain]
    again = _search(demo, **{**query, **options})["items"]
    assert again == found  # the second time from memory


def test_an_upload_by_volumes_of_other_settings(demo: httpx2.Client, take: DemoClip) -> None:
    sent = {"method": "msv-dtw", "q": "1", "start": "0.2", "max_distance": "1e6"}
    file = {"file": ("a.bvh", take.content)}
    answer = demo.post("/v1/search/motion", data=sent, files=file)
    assert answer.status_code == 200, answer.text
    assert answer.json()["items"]


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"q": 1}, "q"),
        ({"eta": 0.3, "method": "dtw"}, "eta"),
        ({"normalized": True, "method": "msv-dtw"}, "normalized"),
        ({"q": 3, "method": "msv-dtw"}, "q"),
        ({"eta": -1, "method": "msv-dtw"}, "eta"),
        ({"max_distance": -1}, "max_distance"),
    ],
)
def test_options_of_volumes_that_do_not_fit_are_refused(
    demo: httpx2.Client, walk: dict[str, Any], options: dict[str, Any], field: str
) -> None:
    answer = demo.post("/v1/search/motion", json={"clip_id": walk["id"], **options})
    assert answer.status_code == 422, answer.text
    assert answer.json()["errors"][0]["location"].endswith(field)


def test_the_nearest_clip_has_the_same_task(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = _search(demo, clip_id=walk["id"], limit=1)
    assert reply["items"][0]["clip"]["task"] == "walk"


def test_the_query_is_a_hit_if_requested(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = _search(demo, clip_id=walk["id"], limit=1, include_self=True)
    assert reply["items"][0]["clip"]["id"] == walk["id"]


def test_pages_go_through_the_whole_ranking(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    whole = [hit["clip"]["id"] for hit in _search(demo, clip_id=walk["id"], limit=1000)["items"]]
    seen: list[str] = []
    cursor: dict[str, str] = {}
    while True:
        reply = _search(demo, clip_id=walk["id"], limit=4, **cursor)
        seen += [hit["clip"]["id"] for hit in reply["items"]]
        if reply["next"] is None:
            break
        cursor = {"cursor": reply["next"]}
    assert seen == whole


def test_filters_narrow(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    for given in ({"task": "kick"}, {"task": ["kick"], "person": ["ada", "bruno"]}):
        reply = _search(demo, clip_id=walk["id"], filter=given, limit=100)
        assert {hit["clip"]["task"] for hit in reply["items"]} == {"kick"}


def test_the_same_person_in_another_task(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    others = {"not_task": "walk"}
    reply = _search(demo, clip_id=walk["id"], method="metric-person", filter=others, limit=2)
    assert {hit["clip"]["person"] for hit in reply["items"]} == {walk["person"]}
    assert "walk" not in {hit["clip"]["task"] for hit in reply["items"]}


@pytest.mark.parametrize("method", LEARNED)
def test_an_upload_searches_by_a_learned_metric(
    demo: httpx2.Client, take: DemoClip, method: str
) -> None:
    sent = {"method": method, "limit": "1", "filter": json.dumps({"not_word": "no_such"})}
    files = {"file": ("q.bvh", take.content)}
    answer = demo.post("/v1/search/motion", data=sent, files=files)
    assert answer.status_code == 200, answer.text
    (hit,) = answer.json()["items"]
    assert hit["clip"]["task"] == take.task
    assert 0 < hit["score"] <= 1


@pytest.mark.parametrize("method", LEARNED)
def test_a_metric_that_is_not_learned_yet(idle: httpx2.Client, take: DemoClip, method: str) -> None:
    files = {"file": ("q.bvh", take.content)}
    answer = idle.post("/v1/search/motion", data={"method": method}, files=files)
    assert_problem(answer, 409, "model_not_fitted")


def test_an_upload_is_searched_like_a_stored_clip(demo: httpx2.Client, take: DemoClip) -> None:
    before = demo.get("/v1/clips", params={"limit": 1000}).json()["items"]
    answer = demo.post(
        "/v1/search/motion",
        files={"file": ("query.bvh", take.content)},
        data={"limit": "3", "filter": json.dumps({"person": "ada"}), "method": "vector"},
    )
    assert answer.status_code == 200, answer.text
    reply = answer.json()
    assert len(reply["items"]) == 3
    assert reply["items"][0]["clip"]["task"] == "walk"
    assert {hit["clip"]["person"] for hit in reply["items"]} == {"ada"}
    assert demo.get("/v1/clips", params={"limit": 1000}).json()["items"] == before


def test_an_unusable_upload_names_the_location(demo: httpx2.Client, take: DemoClip) -> None:
    broken = take.content[: len(take.content) // 2]
    answer = demo.post("/v1/search/motion", files={"file": ("query.bvh", broken)})
    assert answer.status_code == 422
    assert answer.json()["errors"]


def test_parts_of_clips_by_a_part_of_one(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    asked = {"clip_id": walk["id"], "start": 0.5, "end": 1.7, "scope": "windows"}
    reply = _search(demo, **asked, limit=20)
    assert set(reply) == {"method", "took_ms", "library_version", "items", "next"}
    assert reply["items"][0]["clip"]["task"] == "walk"
    for hit in reply["items"]:
        assert set(hit) == {"rank", "score", "distance", "start", "end", "clip"}
        assert 0 <= hit["start"] < hit["end"] <= hit["clip"]["duration"]
        own = hit["clip"]["id"] == walk["id"]
        assert not (own and hit["start"] < 1.6 and hit["end"] > 0.6)
    following = _search(demo, **asked, limit=20, cursor=reply["next"])
    assert [hit["rank"] for hit in following["items"][:2]] == [21, 22]
    itself = _search(demo, **asked, limit=1, include_self=True)["items"][0]
    assert [itself["start"], itself["end"]] == pytest.approx([0.5, 1.7], abs=0.1)


@pytest.mark.parametrize("method", ["fused", "vector", "dtw"])
def test_parts_of_clips_by_a_part_of_an_upload(
    demo: httpx2.Client, take: DemoClip, method: str
) -> None:
    form = {"start": "0.4", "end": "2", "scope": "windows", "method": method, "limit": "1000"}
    form["filter"] = json.dumps({"person": "ada"})
    answer = demo.post("/v1/search/motion", files={"file": ("query.bvh", take.content)}, data=form)
    assert answer.status_code == 200, answer.text
    reply = answer.json()
    assert reply["next"] is None
    assert reply["items"][0]["clip"]["task"] == "walk"
    assert {hit["clip"]["person"] for hit in reply["items"]} == {"ada"}


def test_methods_that_find_no_parts_of_clips(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    body = {"clip_id": walk["id"], "scope": "windows", "method": "msv-dtw"}
    answer = demo.post("/v1/search/motion", json=body)
    assert_problem(answer, 422, "bad_field", "body.method")
    assert "fused, vector, dtw" in answer.json()["errors"][0]["message"]


def test_a_part_outside_of_the_clip(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    answer = demo.post("/v1/search/motion", json={"clip_id": walk["id"], "start": 1e5})
    assert_problem(answer, 422, "bad_field", "body.start")


def test_a_cursor_of_another_question(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    cursor = _search(demo, clip_id=walk["id"], limit=1)["next"]
    body = {"clip_id": walk["id"], "method": "vector", "cursor": cursor}
    answer = demo.post("/v1/search/motion", json=body)
    assert_problem(answer, 404, "page_not_found", "body.cursor")


@pytest.mark.parametrize("mode", ["default", "cca", "printed"])
def test_words_find_motions(demo: httpx2.Client, mode: str) -> None:
    body = {"words": ["walk", "zzyzx"], "mode": mode, "limit": 3}
    reply = demo.post("/v1/search/words", json=body).json()
    assert set(reply) >= {"items", "unknown_words", "expanded", "method", "next", "took_ms"}
    assert reply["unknown_words"] == ["zzyzx"]
    assert reply["items"][0]["clip"]["task"] == "walk"


@pytest.mark.parametrize("method", ["default", "multilinear", "signatures", "perera"])
def test_recognition_of_a_stored_clip(
    demo: httpx2.Client, walk: dict[str, Any], method: str
) -> None:
    reply = demo.post("/v1/recognize", json={"clip_id": walk["id"], "method": method}).json()
    assert set(reply) == {"person", "task", "words", "calibrated", "warnings"}
    for factor in ("person", "task"):
        assert set(reply[factor]) == {"label", "known", "score", "candidates"}
    assert reply["task"]["candidates"][0]["label"] == "walk"
    assert reply["person"]["candidates"][0]["label"] == walk["person"]
    assert all(set(word) == {"word", "score"} for word in reply["words"])


def test_recognition_of_an_upload(demo: httpx2.Client, take: DemoClip) -> None:
    answer = demo.post(
        "/v1/recognize", files={"file": ("a", take.content)}, data={"known_task": "walk"}
    )
    assert answer.status_code == 200, answer.text
    reply = answer.json()["task"]
    assert (reply["label"], reply["known"]) == ("walk", True)


def test_labels_are_counted(demo: httpx2.Client) -> None:
    for path, name in (("persons", "ada"), ("tasks", "walk"), ("words", "walk")):
        reply = demo.get(f"/v1/{path}").json()
        assert reply["next"] is None
        assert {item["name"]: item["count"] for item in reply["items"]}[name] > 0


def test_models_show_the_library_at_their_fit(demo: httpx2.Client) -> None:
    answer = demo.get("/v1/models").json()
    # nobody has named keyposes of the demo's clips
    assert [one["kind"] for one in answer["unfitted"] if one["reason"]] == ["keyposes"]
    reply = answer["items"]
    assert reply
    for model in reply:
        assert set(model) >= {"id", "kind", "version", "library_version", "library_size", "figures"}
        assert model["library_size"] >= 12
    figures = {model["kind"]: model["figures"] for model in reply}
    for kind in LEARNED:
        held_out = figures[kind]["clips_held_out"]
        assert 0 <= held_out["mean_average_precision"] <= 1
        assert figures[kind]["labels"]["fewest_clips"] >= 1
