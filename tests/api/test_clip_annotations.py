"""Annotations over HTTP: kept, corrected, exchanged as files, suggested, and found by words."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from tests.api.conftest import assert_problem


@pytest.fixture
def address(demo: httpx2.Client, walk: dict[str, Any]) -> Iterator[str]:
    """The annotations of a clip. Afterwards it has none."""
    path = f"/v1/clips/{walk['id']}/annotations"
    yield path
    assert demo.put(path, json={"items": []}).json() == {"items": []}


def test_annotations_are_added_corrected_and_deleted(demo: httpx2.Client, address: str) -> None:
    sent = {"start": 0.5, "end": 1.25, "words": ["Left Leg", "step"], "by": "me"}
    answer = demo.post(address, json=sent)
    assert answer.status_code == 201
    made = answer.json()
    assert made["id"].startswith("annotation_")
    assert made["words"] == ["left_leg", "step"]
    assert (made["origin"], made["probability"], made["person"]) == ("person", None, None)
    changed = demo.patch(f"{address}/{made['id']}", json={"end": 1.5, "person": "bo"}).json()
    assert changed == {**made, "end": 1.5, "person": "bo"}
    assert demo.get(f"{address}/{made['id']}").json() == changed
    assert demo.get(address).json() == {"items": [changed]}
    assert demo.delete(f"{address}/{made['id']}").status_code == 204
    assert_problem(
        demo.get(f"{address}/{made['id']}"), 404, "annotation_not_found", "path.annotation_id"
    )


def test_all_annotations_are_replaced_in_order_of_time(demo: httpx2.Client, address: str) -> None:
    later, earlier = (
        {"start": start, "end": start + 0.5, "text": "she steps"} for start in (1.0, 0.0)
    )
    items = demo.put(address, json={"items": [later, earlier, later]}).json()["items"]
    assert [item["start"] for item in items] == [0.0, 1.0]


@pytest.mark.parametrize(
    ("bad", "location"),
    [
        ({"start": 1, "end": 1, "words": ["step"]}, "start"),
        ({"start": 0, "end": 9999, "words": ["step"]}, "end"),
        ({"start": 0, "end": 1}, "words"),
        ({"start": 0, "end": 1, "words": ["a\u0007"]}, "words"),
    ],
)
def test_a_bad_annotation_is_refused_with_its_place(
    demo: httpx2.Client, address: str, bad: dict[str, Any], location: str
) -> None:
    assert_problem(demo.post(address, json=bad), 422, "bad_field", f"body.{location}")
    good = {"start": 0, "end": 1, "words": ["step"]}
    answer = demo.put(address, json={"items": [good, bad]})
    assert_problem(answer, 422, "bad_field", f"body.items.1.{location}")
    assert demo.get(address).json() == {"items": []}


def test_a_clip_that_does_not_exist(demo: httpx2.Client) -> None:
    for method in ("GET", "PUT", "POST"):
        body = {"GET": None, "PUT": {"items": []}, "POST": {"start": 0, "end": 1, "words": ["a"]}}
        answer = demo.request(method, "/v1/clips/clip_0/annotations", json=body[method])
        assert_problem(answer, 404, "clip_not_found")


@pytest.mark.parametrize("format", ["csv", "eaf", "babel"])
def test_files_come_back(demo: httpx2.Client, address: str, format: str) -> None:
    said = {"start": 0.125, "end": 1.5, "words": ["step"], "person": "bo", "text": "Bo steps."}
    before = demo.put(address, json={"items": [said]}).json()["items"]
    file = demo.get(f"{address}/file", params={"format": format})
    assert "attachment" in file.headers["content-disposition"]
    demo.put(address, json={"items": []})
    sent = demo.put(f"{address}/file", data={"format": format}, files={"file": file.content})
    assert sent.status_code == 200, sent.text
    (after,) = sent.json()["items"]
    assert after == {**before[0], "id": after["id"], "origin": "import"}


def test_a_bad_file_is_refused_with_its_line(demo: httpx2.Client, address: str) -> None:
    table = b"start,end,words\r\n0,1,step\r\n2,1,step\r\n"
    answer = demo.put(f"{address}/file", data={"format": "csv"}, files={"file": table})
    assert_problem(answer, 422, "bad_field", "body.line 3: start")
    other = b"clip,start,end,words\r\nother.bvh,0,1,step\r\n"
    answer = demo.put(f"{address}/file", data={"format": "csv"}, files={"file": other})
    assert_problem(answer, 422, "bad_content", "line 2")


def test_the_table_of_the_library(demo: httpx2.Client, address: str, walk: dict[str, Any]) -> None:
    demo.put(address, json={"items": [{"start": 0, "end": 1, "words": ["step"]}]})
    rows = demo.get("/v1/annotations.csv").text.splitlines()
    assert rows[0] == "clip,start,end,words,person,text,by"
    assert any(row.endswith("0,1,step,,,") or ",step," in row for row in rows[1:])
    others = demo.get("/v1/annotations.csv", params={"not_person": walk["person"]})
    assert len(others.text.splitlines()) == 1


def test_words_find_moments_and_segments(demo: httpx2.Client) -> None:
    for scope in ("windows", "segments"):
        answer = demo.post("/v1/search/words", json={"words": ["walk"], "scope": scope})
        assert answer.status_code == 200, answer.text
        hits = answer.json()["items"]
        assert hits[0]["clip"]["task"] == "walk"
        spans = [(hit["start"], hit["end"], hit["clip"]["duration"] + 1e-5) for hit in hits]
        assert all(0 <= start < end <= duration for start, end, duration in spans)
        assert [hit["score"] for hit in hits] == sorted(
            (hit["score"] for hit in hits), reverse=True
        )
        first = demo.post(
            "/v1/search/words", json={"words": ["walk"], "scope": scope, "limit": 2}
        ).json()
        rest = demo.post(
            "/v1/search/words",
            json={"words": ["walk"], "scope": scope, "limit": 2, "cursor": first["next"]},
        ).json()
        paged = [(hit["clip"]["id"], hit["start"]) for hit in first["items"] + rest["items"]]
        assert paged == [(hit["clip"]["id"], hit["start"]) for hit in hits[:4]]


def test_a_word_with_a_minus_leaves_out_its_moments(demo: httpx2.Client) -> None:
    sent = {"words": ["walk", "-walk"], "scope": "windows"}
    hits = demo.post("/v1/search/words", json=sent).json()["items"]
    assert all(hit["score"] < 0.5 for hit in hits)
    only = demo.post("/v1/search/words", json={"words": ["-walk"], "scope": "windows"}).json()
    assert only["items"][0]["clip"]["task"] != "walk"


def test_other_modes_know_only_clips(demo: httpx2.Client) -> None:
    sent = {"words": ["walk"], "scope": "windows", "mode": "cca"}
    assert_problem(demo.post("/v1/search/words", json=sent), 422, "bad_field", "body.mode")


def test_suggestions_are_accepted_with_one_call(
    demo: httpx2.Client, address: str, walk: dict[str, Any]
) -> None:
    suggested = demo.get(f"{address}/suggestions").json()["items"]
    assert suggested
    assert "walk" in suggested[0]["words"]
    assert all(0.5 <= one["probability"] <= 1 for one in suggested)
    one = {name: suggested[0][name] for name in ("start", "end")}
    accepted = demo.post(f"{address}/suggestions/accept", json={"items": [one], "by": "me"})
    (made,) = accepted.json()["items"]
    assert (made["origin"], made["by"], made["words"]) == (
        "suggestion",
        "me",
        suggested[0]["words"],
    )
    assert demo.get(f"{address}/suggestions").json()["items"] == suggested[1:]
    answer = demo.post(f"{address}/suggestions/accept", json={"items": [one]})
    assert_problem(answer, 422, "bad_field", "body.items.0")
    every = demo.post(f"{address}/suggestions/accept").json()["items"]
    assert len(every) == len(suggested)
