"""What lists have in common: totals, and items with chosen fields."""

from __future__ import annotations

import json
from typing import Any

import httpx2
import pytest

from app.api.schemas.clips import Clip
from app.api.schemas.search import Hit
from tests.api.conftest import assert_problem

LISTS = [
    "/v1/clips",
    "/v1/jobs",
    "/v1/persons",
    "/v1/tasks",
    "/v1/words",
    "/v1/sources",
    "/v1/licenses",
]
LISTS += ["/v1/studies/low-dimensional/pairs"]
SEARCHES = ["motion", "words", "pose"]


def _search(client: httpx2.Client, kind: str, clip_id: str, **params: str) -> httpx2.Response:
    bodies: dict[str, Any] = {
        "motion": {"clip_id": clip_id},
        "words": {"words": ["walk"]},
        "pose": {"clip_id": clip_id, "time": 0.5},
    }
    return client.post(f"/v1/search/{kind}", json={**bodies[kind], "limit": 3}, params=params)


@pytest.mark.parametrize("path", LISTS)
def test_every_list_says_how_long_it_is(demo: httpx2.Client, path: str) -> None:
    whole = demo.get(path, params={"limit": 1000}).json()
    assert (whole["total"], whole["total_is_exact"]) == (len(whole["items"]), True)
    first = demo.get(path, params={"limit": 1}).json()
    assert first["total"] == whole["total"]
    if first["next"]:
        second = demo.get(path, params={"limit": 1, "cursor": first["next"]}).json()
        assert second["total"] == whole["total"]


def test_a_total_counts_what_the_filter_passes(demo: httpx2.Client) -> None:
    walks = demo.get("/v1/clips", params={"task": "walk", "limit": 1}).json()
    assert walks["total"] == 4
    assert demo.get("/v1/clips", params={"q": "no such name"}).json()["total"] == 0
    assert demo.get("/v1/jobs", params={"kind": "fit", "limit": 1}).json()["total"] == 1


def test_completions_that_fill_their_page_may_be_more(demo: httpx2.Client) -> None:
    some = demo.get("/v1/words", params={"q": "w", "limit": 1}).json()
    assert (some["total"], some["total_is_exact"]) == (1, False)


@pytest.mark.parametrize("field", sorted(Clip.model_fields))
def test_each_field_of_a_clip_can_be_chosen(
    demo: httpx2.Client, walk: dict[str, Any], field: str
) -> None:
    alone = demo.get(f"/v1/clips/{walk['id']}", params={"fields": field}).json()
    assert alone == {field: walk[field]}


def test_fields_of_a_list_are_those_of_whole_clips(demo: httpx2.Client) -> None:
    whole = demo.get("/v1/clips", params={"limit": 5}).json()
    sparse = demo.get("/v1/clips", params={"limit": 5, "fields": "name,roles, id"}).json()
    chosen = [{name: clip[name] for name in ("id", "name", "roles")} for clip in whole["items"]]
    assert sparse == {**whole, "items": chosen}
    assert list(sparse["items"][0]) == ["id", "name", "roles"]
    repeated = demo.get("/v1/clips?limit=5&fields=name&fields=roles&fields=id").json()
    assert repeated == sparse


@pytest.mark.parametrize("kind", SEARCHES)
def test_fields_of_hits_are_those_of_whole_hits(
    demo: httpx2.Client, walk: dict[str, Any], kind: str
) -> None:
    whole = _search(demo, kind, walk["id"]).json()
    fields = "score,start,end,clip.id,clip.warnings"
    sparse = _search(demo, kind, walk["id"], fields=fields).json()
    assert sparse["items"] == [
        {
            **{name: hit[name] for name in ("score", "start", "end")},
            "clip": {name: hit["clip"][name] for name in ("id", "warnings")},
        }
        for hit in whole["items"]
    ]
    assert sparse.keys() == whole.keys()
    all_of_the_clip = _search(demo, kind, walk["id"], fields="clip").json()
    assert all_of_the_clip["items"] == [{"clip": hit["clip"]} for hit in whole["items"]]
    assert len(whole["items"]) == 3


@pytest.mark.parametrize("fields", ["nam", "clip.nam", "name.x", "id.", "_sa", ".", "id,nam"])
def test_an_unknown_field_is_named(demo: httpx2.Client, walk: dict[str, Any], fields: str) -> None:
    for answer in (
        demo.get("/v1/clips", params={"fields": fields}),
        demo.get(f"/v1/clips/{walk['id']}", params={"fields": fields}),
        _search(demo, "motion", walk["id"], fields=fields),
    ):
        assert_problem(answer, 422, "bad_field", "query.fields")


def test_too_many_fields_or_none_are_refused(demo: httpx2.Client) -> None:
    for fields in (",".join(["id"] * 61), "", " , "):
        assert demo.get("/v1/clips", params={"fields": fields}).status_code == 422
    assert {"clip", "score"} <= Hit.model_fields.keys()


TREE = {"any_of": [{"task": "walk"}, {"task": "kick", "none_of": [{"person": "ada"}]}]}


def test_lists_and_searches_filter_by_a_tree(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    text = json.dumps(TREE)
    listed = demo.get("/v1/clips", params={"where": text, "limit": 100}).json()
    found = {(clip["task"], clip["person"]) for clip in listed["items"]}
    assert {task for task, _ in found} == {"walk", "kick"}
    assert ("kick", "ada") not in found
    assert listed["total"] == len(listed["items"])
    body = {"examples": [{"clip_id": walk["id"]}], "include_self": True, "limit": 100}
    for where in (TREE, text):
        hits = demo.post("/v1/search", json={**body, "filter": {"where": where}}).json()["items"]
        assert {hit["clip"]["id"] for hit in hits} == {clip["id"] for clip in listed["items"]}
    measured = demo.get("/v1/measures", params={"where": text})
    assert measured.status_code == 200


def test_a_saved_search_keeps_its_tree(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    query = {"examples": [{"clip_id": walk["id"]}], "filter": {"where": TREE}, "limit": 100}
    direct = demo.post("/v1/search", json=query).json()["items"]
    saved = demo.post("/v1/searches", json={"name": "a tree", "query": query}).json()
    assert saved["query"]["filter"] == {"where": TREE}
    again = demo.get(f"/v1/searches/{saved['id']}/hits").json()["items"]
    assert [hit["clip"]["id"] for hit in again] == [hit["clip"]["id"] for hit in direct]
    demo.delete(f"/v1/searches/{saved['id']}")


@pytest.mark.parametrize(
    ("where", "location"),
    [("[1", "where"), ("[]", "where"), ('{"all_of": [{"tsak": "a"}]}', "all_of.0.tsak")],
)
def test_a_wrong_tree_is_a_problem(demo: httpx2.Client, where: str, location: str) -> None:
    answer = demo.get("/v1/clips", params={"where": where})
    assert_problem(answer, 422, "bad_field")
    assert location in answer.text
