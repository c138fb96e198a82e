"""Edits that make new clips, over HTTP, by the Python client and by the command."""

from __future__ import annotations

from typing import Any

import httpx2
import numpy as np
import pytest

from kinedex import Kinedex
from tests.api.conftest import assert_problem
from tests.live import Live

ROUNDING = 1e-4


def test_an_edit_makes_a_clip_with_the_same_motion(
    demo_service: Live, demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    asked = {"steps": [{"kind": "cut", "start": 0.2, "end": 1.4}], "name": "a piece"}
    answer = demo.post(f"/v1/clips/{walk['id']}/edits", json=asked)
    assert answer.status_code == 202, answer.text
    demo_service.wait_for_job(answer.json()["job"]["id"])
    clip_id = answer.json()["clip"]["id"]
    clip = demo.get(f"/v1/clips/{clip_id}").json()
    assert (clip["state"], clip["name"], clip["task"]) == ("ready", "a piece", "walk")
    steps = [{"kind": "cut", "start": 0.2, "end": 1.4}]
    assert clip["origin"] == {"clip_id": walk["id"], "deleted": False, "steps": steps}
    assert demo.post(f"/v1/clips/{walk['id']}/edits", json=asked).status_code == 200
    rows = demo.get("/v1/audit", params={"clip": walk["id"], "action": "edit_clip"}).json()
    assert rows["items"][0]["details"] == {"new_clip_id": clip_id, "steps": ["cut"]}
    with Kinedex(demo_service.url) as client:
        whole, cut = client.clips.motion(walk["id"]), client.clips.motion(clip_id)
        first = round(0.2 * whole.frame_rate)
        expected = whole.positions[first : first + len(cut.positions)]
        assert np.abs(cut.positions - expected).max() < ROUNDING
        mirrored = client.clips.edit(walk["id"], [{"kind": "mirror"}])
        assert mirrored.clip.name.endswith("(mirror)")
        client.clips.delete(mirrored.clip.id)
        client.clips.delete(clip_id)


def test_the_copy_says_that_the_original_was_deleted(
    demo_service: Live, demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    def made(clip_id: str, *steps: dict[str, Any]) -> str:
        answer = demo.post(f"/v1/clips/{clip_id}/edits", json={"steps": steps}).json()
        demo_service.wait_for_job(answer["job"]["id"])
        new_id: str = answer["clip"]["id"]
        return new_id

    original = made(walk["id"], {"kind": "resample", "fps": 24})
    copy = made(original, {"kind": "in_place"}, {"kind": "loop"})
    assert demo.get(f"/v1/clips/{copy}").json()["origin"]["deleted"] is False
    demo.delete(f"/v1/clips/{original}")
    origin = demo.get(f"/v1/clips/{copy}").json()["origin"]
    assert (origin["deleted"], origin["clip_id"]) == (True, original)
    assert [step["kind"] for step in origin["steps"]] == ["in_place", "loop"]
    demo.delete(f"/v1/clips/{copy}")


@pytest.mark.parametrize(
    ("body", "place"),
    [
        ({"steps": []}, "body.steps"),
        ({"steps": [{"kind": "shrink"}]}, "body.steps.0.kind"),
        ({"steps": [{"kind": "cut", "start": 0, "end": 0}]}, "body.steps.0.end"),
        ({"steps": [{"kind": "mirror", "fps": 30}]}, "body.steps.0.fps"),
    ],
)
def test_wrong_steps_are_refused(
    demo: httpx2.Client, walk: dict[str, Any], body: dict[str, Any], place: str
) -> None:
    answer = demo.post(f"/v1/clips/{walk['id']}/edits", json=body)
    assert answer.status_code == 422
    assert [one["location"] for one in answer.json()["errors"]] == [place]


def test_only_ready_clips_are_edited(demo: httpx2.Client) -> None:
    answer = demo.post("/v1/clips/clip_none/edits", json={"steps": [{"kind": "mirror"}]})
    assert_problem(answer, 404, "clip_not_found")
