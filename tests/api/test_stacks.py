"""The `stack` of an FBX file over HTTP."""

from __future__ import annotations

from typing import Any

import httpx2

from tests.api.conftest import assert_problem
from tests.api.test_clips import CLIP_FIELDS
from tests.formats.fbx.takes import person_takes
from tests.formats.samples import bvh
from tests.live import Live

TAKES = person_takes({"bow": 1.0, "sway": 2.0})


def _sent(stack: str) -> dict[str, Any]:
    return {"files": {"file": ("takes.fbx", TAKES)}, "data": {"stack": stack}}


def test_a_stack_can_be_chosen_at_upload_later_and_for_a_query(demo_service: Live) -> None:
    with demo_service.client() as client:
        reply = client.post("/v1/clips", **_sent("run")).json()
        demo_service.wait_for_job(reply["job"]["id"])
        path = f"/v1/clips/{reply['clip']['id']}"
        failed = client.get(path).json()
        assert (failed["state"], failed["error"]["code"]) == ("failed", "bad_field")
        assert "bow, sway" in failed["error"]["errors"][0]["message"]
        again = client.post("/v1/clips", **_sent("bow")).json()
        demo_service.wait_for_job(again["job"]["id"])
        clip = client.get(path).json()
        assert (clip["state"], clip["frames"], set(clip)) == (
            "ready",
            31,
            CLIP_FIELDS | {"measures"},
        )

        def found(stack: str, **more: str) -> list[str]:
            sent = _sent(stack)
            sent["data"] |= {"limit": "100"} | more
            hits = client.post("/v1/search/motion", **sent).json()["items"]
            return [hit["clip"]["id"] for hit in hits]

        assert found("bow", include_self="true")[0] == clip["id"]
        assert clip["id"] not in found("bow")
        assert clip["id"] in found("sway")  # another motion of the same file
        assert client.post("/v1/recognize", **_sent("sway")).status_code == 200
        for url in ("/v1/search/motion", "/v1/recognize"):
            assert_problem(client.post(url, **_sent("run")), 422, "bad_field", "body.stack")
        assert client.patch(path, json={"stack": None}).json()["reanalysis"] == "queued"
        assert client.delete(path).status_code == 204


def test_a_stack_with_another_format_is_refused(idle: httpx2.Client) -> None:
    files = {"file": ("a.bvh", bvh())}
    answer = idle.post("/v1/clips", files=files, data={"stack": "bow"})
    assert_problem(answer, 422, "bad_field", "body.stack")
