"""Words over HTTP: completed, suggested, accepted; sentences; the map of motions."""

from __future__ import annotations

from typing import Any

import httpx2
import pytest


def test_a_sentence_is_understood(demo: httpx2.Client) -> None:
    reply = demo.post(
        "/v1/search/words", json={"words": ["somebody is strolling", "-kicking", "zebra"]}
    ).json()
    assert reply["unknown_words"] == ["zebra"]
    assert reply["items"][0]["clip"]["task"] == "walk"
    assert "kick" not in {hit["clip"]["task"] for hit in reply["items"]}


def test_a_search_may_only_exclude_words(demo: httpx2.Client) -> None:
    for mode in ("default", "cca", "printed"):
        reply = demo.post("/v1/search/words", json={"words": ["-walking"], "mode": mode}).json()
        assert reply["items"]
        assert "walk" not in {hit["clip"]["task"] for hit in reply["items"]}
        scores = [hit["score"] for hit in reply["items"]]
        assert scores == sorted(scores, reverse=True)
        assert scores[0] > 0.9
    nothing = demo.post("/v1/search/words", json={"words": ["-zebra"]}).json()
    assert (nothing["items"], nothing["unknown_words"]) == ([], ["zebra"])


def test_words_are_completed(demo: httpx2.Client) -> None:
    every = demo.get("/v1/words").json()["items"]
    first = every[0]["name"]
    found = demo.get("/v1/words", params={"q": first[:2].upper(), "limit": 3}).json()["items"]
    assert first in {item["name"] for item in found}
    assert 1 <= len(found) <= 3


def test_words_are_suggested_and_accepted(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    path = f"/v1/clips/{walk['id']}/word-suggestions"
    found = demo.get(path, params={"limit": 2}).json()
    assert len(found["items"]) == 2
    assert found["next"] is None
    through_space = demo.get(path, params={"limit": 100, "mode": "cca"}).json()["items"]
    assert {item["word"] for item in through_space}.isdisjoint(walk["words"])
    assert [item["score"] for item in through_space] != [item["score"] for item in found["items"]]
    assert demo.get(path, params={"mode": "guess"}).status_code == 422
    same = demo.post(f"{path}/accept", json={"words": walk["words"][:1]})
    assert same.status_code == 200
    assert same.json()["words"] == walk["words"]
    assert demo.get("/v1/clips/nobody/word-suggestions").status_code == 404
    assert demo.post("/v1/clips/nobody/word-suggestions/accept", json={}).status_code == 404
    assert demo.post("/v1/clips/nobody/word-suggestions/accept").status_code == 404
    assert demo.post(f"{path}/accept", content=b"words").status_code == 415


@pytest.mark.parametrize("space", ["symbols", "vectors"])
def test_the_map_names_every_clip(demo: httpx2.Client, space: str) -> None:
    reply = demo.get("/v1/space", params={"space": space, "dimensions": 3}).json()
    assert reply["dimensions"] == 3
    assert len(reply["items"]) == reply["total"] > 0
    assert all(len(item["point"]) == 3 for item in reply["items"])
    clips = {clip["id"]: clip for clip in demo.get("/v1/clips?limit=1000").json()["items"]}
    for item in reply["items"]:
        shown = ("person", "task", "words", "license", "source", "metadata", "duration")
        assert all(item[name] == clips[item["clip_id"]][name] for name in shown)
    columns = demo.get("/v1/space/columns", params={"space": space, "dimensions": 3}).json()
    assert columns["clip_ids"] == [item["clip_id"] for item in reply["items"]]
    for index, item in enumerate(reply["items"]):
        place = [axis[index] for axis in columns["points"]]
        assert place == pytest.approx(item["point"], rel=1e-4)
        for name, column in columns["labels"].items():
            code = column["codes"][index]
            assert (column["values"][code] if code >= 0 else None) == item[name], name
        own = {
            key: column["values"][column["codes"][column["clips"].index(index)]]
            for key, column in columns["metadata"].items()
            if index in column["clips"]
        }
        assert own == item["metadata"]
        words = columns["words"]
        assert words["values"][words["codes"][index]] == sorted(item["words"])
        for name, values in columns["measures"].items():
            assert values[index] == (item[name] and pytest.approx(item[name], rel=1e-4)), name
    only = demo.get("/v1/space", params={"space": space, "task": "walk"}).json()
    assert {item["task"] for item in only["items"]} == {"walk"}
    assert demo.get("/v1/space", params={"dimensions": 4}).status_code == 422
    described = demo.get("/openapi.json").json()["paths"]["/v1/space"]["get"]["parameters"]
    (dimensions,) = [one["schema"] for one in described if one["name"] == "dimensions"]
    assert (dimensions["type"], dimensions["minimum"], dimensions["maximum"]) == ("integer", 2, 3)


def test_forgetting_an_unknown_person_is_not_found(demo: httpx2.Client) -> None:
    answer = demo.delete("/v1/persons/nobody at all")
    assert answer.status_code == 404
    assert answer.headers["content-type"].startswith("application/problem+json")
