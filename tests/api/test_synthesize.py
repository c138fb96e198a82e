"""`POST /v1/synthesize` over HTTP."""

from __future__ import annotations

from typing import Any

import httpx2
import numpy as np

from app.formats.read import read_recording
from tests.api.conftest import assert_problem

CALL = "/v1/synthesize"


def test_a_motion_comes_with_its_quality_and_is_not_stored(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    before = demo.get("/v1/persons").json()
    answer = demo.post(CALL, json={"clip_ids": [walk["id"]], "task": "wave", "bvh": True})
    assert answer.status_code == 200, answer.text
    reply = answer.json()
    assert list(reply) == ["clip", "job", "cycles", "quality", "motion", "bvh"]
    assert reply["clip"]["id"] is None
    assert reply["job"] is None
    assert (reply["clip"]["task"], reply["clip"]["source"]) == ("wave", "synthesized")
    assert reply["clip"]["person"] == walk["person"]
    assert reply["quality"]["kind"] == "new_person"
    assert reply["quality"]["given_tasks"] == ["walk"]
    assert reply["quality"]["nearest_clip"]["task"] == reply["quality"]["nearest_task"]
    positions = np.array(reply["motion"]["positions"])
    shape = (reply["clip"]["frames"], reply["clip"]["joints"], 3)
    assert positions.shape == shape
    recording = read_recording(reply["bvh"].encode())
    np.testing.assert_allclose(recording.positions / 100, positions, atol=2e-3)
    assert demo.get("/v1/persons").json() == before


def test_octets_are_the_positions_alone(demo: httpx2.Client) -> None:
    asked = {"person": "ada", "task": "walk", "seconds": 2}
    octets = demo.post(CALL, json=asked, headers={"Accept": "application/octet-stream"})
    assert octets.status_code == 200
    reply = demo.post(CALL, json=asked).json()
    assert reply["bvh"] is None
    assert reply["quality"]["kind"] == "seen"
    shape = tuple(int(size) for size in octets.headers["x-shape"].split(","))
    sent = np.frombuffer(octets.content, dtype="<f4").reshape(shape)
    np.testing.assert_allclose(sent, reply["motion"]["positions"], atol=1e-5)


def test_a_stored_motion_is_answered_201_and_then_200(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    asked = {"clip_ids": [walk["id"]], "task": "kick", "store": True}
    before = {path: _counts(demo, path) for path in ("persons", "tasks", "words")}
    first = demo.post(CALL, json=asked)
    assert first.status_code == 201, first.text
    clip = first.json()["clip"]
    try:
        assert clip["state"] == "queued"
        assert first.json()["job"]["kind"] == "ingest"
        second = demo.post(CALL, json=asked)
        assert (second.status_code, second.json()["clip"]["id"]) == (200, clip["id"])
        assert demo.get(f"/v1/clips/{clip['id']}").json()["source"] == "synthesized"
        for path, name in (("persons", walk["person"]), ("tasks", "kick"), ("words", "kick")):
            assert _counts(demo, path)[name] == before[path][name] | {"synthesized": 1}
    finally:
        demo.delete(f"/v1/clips/{clip['id']}")


def _counts(demo: httpx2.Client, path: str) -> dict[str, dict[str, Any]]:
    return {one["name"]: one for one in demo.get(f"/v1/{path}").json()["items"]}


def test_a_motion_that_cannot_be_made_is_a_problem(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    unknown = demo.post(CALL, json={"person": "nobody", "task": "walk"})
    assert_problem(unknown, 404, "not_found", "body.person")
    task = demo.post(CALL, json={"person": "ada", "task": "fly"})
    assert_problem(task, 404, "not_found", "body.task")
    clip = demo.post(CALL, json={"clip_ids": ["nowhere"], "task": "walk"})
    assert_problem(clip, 404, "clip_not_found", "body.clip_ids.0")
    ids = [walk["id"], "nowhere", walk["id"], "lost", "nowhere"]
    several = demo.post(CALL, json={"clip_ids": ids, "task": "wave"})
    wrong = [f"body.clip_ids.{place}" for place in (1, 3, 4)]
    assert_problem(several, 404, "clip_not_found", *wrong)
    assert len(several.json()["errors"]) == len(wrong)
    assert several.json()["detail"] == "There are no clips with the ids 'nowhere', 'lost'"
    same = demo.post(CALL, json={"clip_ids": [walk["id"]], "task": "walk"})
    assert_problem(same, 409, "not_enough_labels", "body.clip_ids")
    for asked in (
        {"task": "walk"},
        {"task": "walk", "person": "ada", "clip_ids": [walk["id"]]},
        {"task": "walk", "clip_ids": []},
        {"task": "walk", "person": "ada", "seconds": 1e9},
        {"task": "walk", "person": "ada", "mood": "merry"},
    ):
        assert_problem(demo.post(CALL, json=asked), 422, "bad_field")
    both = demo.post(CALL, json={"task": "walk", "person": "ada", "clip_ids": [walk["id"]]}).json()
    assert both["errors"][0]["message"] == "send exactly one of person and clip_ids"


def test_a_library_without_models_says_so(idle: httpx2.Client) -> None:
    answer = idle.post(CALL, json={"person": "ada", "task": "walk"})
    assert_problem(answer, 409, "model_not_fitted")
