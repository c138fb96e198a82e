"""The study over HTTP: a page can run it, and no answer reveals the sides."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import httpx2
import numpy as np
import pytest

from tests.api.conftest import assert_problem

PAIRS = "/v1/studies/low-dimensional/pairs"
TALLY = "/v1/studies/low-dimensional/tally"


@pytest.fixture
def pair(demo: httpx2.Client) -> Iterator[dict[str, Any]]:
    clip = demo.get("/v1/clips", params={"task": "wave"}).json()["items"][0]
    answer = demo.post(PAIRS, json={"clip_id": clip["id"], "dimensions": 2})
    assert answer.status_code == 201, answer.text
    yield answer.json()
    for made in demo.get(PAIRS, params={"limit": 1000}).json()["items"]:
        assert demo.delete(f"{PAIRS}/{made['id']}").status_code == 204


def test_a_page_can_run_it(demo: httpx2.Client, pair: dict[str, Any]) -> None:
    assert demo.get(f"{PAIRS}/{pair['id']}").json() == pair
    motions = {side: demo.get(pair[side]).json() for side in ("left", "original", "right")}
    shapes = {np.array(motion["positions"]).shape for motion in motions.values()}
    assert len(shapes) == 1
    assert motions["left"]["positions"] != motions["right"]["positions"]
    assert demo.get(pair["animation"]).headers["content-type"] == "image/svg+xml"
    vote = demo.post(pair["votes"], json={"choice": "left", "voter": "x1"})
    assert vote.status_code == 201
    assert vote.json() == {"id": vote.json()["id"], "pair_id": pair["id"], "choice": "left"}
    reply = demo.get(TALLY).json()
    assert reply["total"]["keypose"] + reply["total"]["uniform"] == 1
    assert [row["clip_id"] for row in reply["sequences"]] == [pair["clip_id"]]
    assert reply["left_share"] == 1.0
    assert demo.get(TALLY, params={"clip_id": pair["clip_id"]}).json() == reply


def test_no_answer_reveals_the_sides(demo: httpx2.Client, pair: dict[str, Any]) -> None:
    answers = [demo.get(pair[side]) for side in ("left", "original", "right")]
    assert len({tuple(answer.json()) for answer in answers}) == 1
    stable = [
        {k: v for k, v in answer.headers.items() if k not in ("date", "x-request-id")}
        for answer in answers
    ]
    assert stable[0] == stable[1] == stable[2]
    octets = [
        demo.get(pair[side], headers={"Accept": "application/octet-stream"}).headers
        for side in ("left", "right")
    ]
    for name in ("x-shape", "x-frame-rate", "content-length"):
        assert octets[0][name] == octets[1][name]
    shown = demo.get(f"{PAIRS}/{pair['id']}").text + demo.get(PAIRS).text
    assert "keypose" not in shown
    assert "uniform" not in shown


def test_motions_come_at_any_rate(demo: httpx2.Client, pair: dict[str, Any]) -> None:
    slow = demo.get(pair["left"], params={"fps": 10}).json()
    usual = demo.get(pair["left"]).json()
    assert (slow["frame_rate"], usual["frame_rate"]) == (10, 30)
    assert len(slow["positions"]) == pytest.approx(len(usual["positions"]) / 3, abs=1)
    assert_problem(demo.get(pair["left"], params={"fps": 0}), 422, "bad_field", "query.fps")


def test_a_second_vote_of_a_voter_is_refused(demo: httpx2.Client, pair: dict[str, Any]) -> None:
    ballot = {"choice": "same", "voter": "x2"}
    assert demo.post(pair["votes"], json=ballot).status_code == 201
    assert_problem(demo.post(pair["votes"], json=ballot), 409, "already_voted")


@pytest.mark.parametrize(
    ("body", "location"),
    [
        ({}, "body.choice"),
        ({"choice": "keypose"}, "body.choice"),
        ({"choice": "left", "voter": ""}, "body.voter"),
        ({"choice": "left", "side": "left"}, "body.side"),
    ],
)
def test_bad_votes_are_named(
    demo: httpx2.Client, pair: dict[str, Any], body: dict[str, str], location: str
) -> None:
    assert_problem(demo.post(pair["votes"], json=body), 422, "bad_field", location)


def test_bad_pairs_are_named(demo: httpx2.Client, pair: dict[str, Any]) -> None:
    clip = {"clip_id": pair["clip_id"]}
    assert_problem(demo.post(PAIRS, json={}), 422, "bad_field", "body.clip_id")
    answer = demo.post(PAIRS, json=clip | {"dimensions": 400})
    assert_problem(answer, 422, "bad_field", "body.dimensions")
    answer = demo.post(PAIRS, json={"clip_id": "none"})
    assert_problem(answer, 404, "clip_not_found", "body.clip_id")
    answer = demo.post(PAIRS, json=clip | {"model_clips": [pair["clip_id"], "none", "no"]})
    assert_problem(answer, 404, "clip_not_found", "body.model_clips.1", "body.model_clips.2")


def test_unknown_pairs_are_not_found(demo: httpx2.Client) -> None:
    for path in ("", "/left", "/animation.svg"):
        assert_problem(demo.get(f"{PAIRS}/none{path}"), 404, "not_found")
    assert_problem(demo.delete(f"{PAIRS}/none"), 404, "not_found")
    answer = demo.post(f"{PAIRS}/none/votes", json={"choice": "left"})
    assert_problem(answer, 404, "not_found")
    assert_problem(demo.get(f"{PAIRS}/none/middle"), 422, "bad_field", "path.side")
    answer = demo.get(TALLY, params={"clip_id": "none"})
    assert_problem(answer, 404, "clip_not_found", "query.clip_id")
