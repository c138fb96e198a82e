"""The `skeleton` of an AMC file over HTTP."""

from __future__ import annotations

import httpx2

from tests.api.conftest import assert_problem
from tests.formats.acclaim.files import acclaim_person
from tests.formats.samples import bvh
from tests.live import Live

ASF, AMC, _ = acclaim_person(frames=60, seed=5)


def test_a_pair_is_one_clip_and_one_query(demo_service: Live) -> None:
    def pair() -> dict[str, tuple[str, bytes]]:
        return {"file": ("07_01.amc", AMC), "skeleton": ("07.asf", ASF)}

    with demo_service.client() as client:
        answer = client.post("/v1/clips", files=pair())
        assert answer.status_code == 202, answer.text
        reply = answer.json()
        demo_service.wait_for_job(reply["job"]["id"])
        clip = client.get(f"/v1/clips/{reply['clip']['id']}").json()
        assert (clip["state"], clip["format"], clip["frame_rate"]) == ("ready", "amc", 120)
        assert clip["declared_frame_rate"] is None
        assert client.post("/v1/clips", files=pair()).status_code == 200
        for include_self in ("true", "false"):
            asked = {"limit": "1", "include_self": include_self}
            hits = client.post("/v1/search/motion", files=pair(), data=asked).json()
            is_itself = hits["items"][0]["clip"]["id"] == clip["id"]
            assert is_itself == (include_self == "true")
        recognized = client.post("/v1/recognize", files=pair())
        assert recognized.status_code == 200, recognized.text
        assert client.delete(f"/v1/clips/{clip['id']}").status_code == 204


def test_a_skeleton_with_another_format_is_refused(idle: httpx2.Client) -> None:
    files = {"file": ("a.bvh", bvh()), "skeleton": ("07.asf", ASF)}
    assert_problem(idle.post("/v1/clips", files=files), 422, "bad_field", "body.skeleton")


def test_a_query_without_its_skeleton_names_the_missing_field(demo: httpx2.Client) -> None:
    answer = demo.post("/v1/search/motion", files={"file": ("07_01.amc", AMC)})
    assert_problem(answer, 422, "skeleton_needed", "skeleton")
