"""Clips over HTTP, against a running service."""

from __future__ import annotations

import hashlib
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx2
import numpy as np
import pytest

from app.demo import DemoClip, demo_clips
from tests.api.conftest import assert_problem
from tests.live import Live

CLIP_FIELDS = {
    *("id", "name", "state", "format", "sha256", "person", "task", "words", "license"),
    *("source", "frames", "frame_rate", "declared_frame_rate", "duration", "start_offset"),
    *("travel", "speed", "energy", "tempo"),
    *("joints", "roles", "missing_roles", "warnings", "created_at", "error"),
    *("has_audio", "audio_offset", "reanalysis", "path", "metadata", "captions", "origin"),
}
JOB_FIELDS = {
    *("id", "kind", "state", "clip_id", "progress", "detail"),
    *("created_at", "started_at", "finished_at", "result", "error"),
}


def _post(client: httpx2.Client, content: bytes, name: str = "a.bvh", **data: str) -> Any:
    return client.post("/v1/clips", files={"file": (name, content)}, data=data)


def test_an_upload_is_acknowledged_then_ready(demo_service: Live, take: DemoClip) -> None:
    answer = demo_service.upload(take, license="CC0-1.0", source="test")
    assert answer.status_code == 202
    reply = answer.json()
    assert set(reply) == {"clip", "job", "differences"}
    assert set(reply["clip"]) == CLIP_FIELDS
    assert set(reply["job"]) == JOB_FIELDS
    assert reply["clip"]["state"] == "queued"
    assert reply["clip"]["sha256"] == hashlib.sha256(take.content).hexdigest()
    job = demo_service.wait_for_job(reply["job"]["id"])
    assert (job["state"], job["progress"]) == ("succeeded", 1.0)
    assert job["clip_id"] == reply["clip"]["id"]
    with demo_service.client() as client:
        clip = client.get(f"/v1/clips/{reply['clip']['id']}").json()
        assert clip["state"] == "ready"
        assert clip["person"] == "chika"
        assert clip["words"] == list(take.words)
        assert clip["license"] == "CC0-1.0"
        assert clip["error"] is None
        assert clip["joints"] > 13
        assert clip["roles"]["hips"]
        assert clip["duration"] == pytest.approx(clip["frames"] / clip["frame_rate"])
        again = demo_service.upload(take)
        assert again.status_code == 200
        assert again.json()["clip"]["id"] == clip["id"]
        assert client.delete(f"/v1/clips/{clip['id']}").status_code == 204
        assert_problem(client.get(f"/v1/clips/{clip['id']}"), 404, "clip_not_found")


def test_words_of_a_form_are_separated_by_spaces(idle: httpx2.Client) -> None:
    answer = _post(idle, _tiny(1), words="Walk left_leg  slow").json()
    assert answer["clip"]["words"] == ["walk", "left_leg", "slow"]


def test_captions_are_kept_found_corrected_and_exported(idle: httpx2.Client) -> None:
    sent = "Somebody walks. | He turns left\nSomebody walks."
    clip = _post(idle, _tiny(7), captions=sent, source="captioned").json()["clip"]
    assert clip["captions"] == ["Somebody walks.", "He turns left"]
    found = idle.get("/v1/clips", params={"q": "turns LEFT"}).json()["items"]
    assert [one["id"] for one in found] == [clip["id"]]
    table = idle.get("/v1/manifest.csv", params={"source": "captioned"}).text
    assert "Somebody walks. | He turns left" in table
    path = f"/v1/clips/{clip['id']}"
    changed = idle.patch(path, json={"captions": ["A walk"]}).json()
    assert changed["captions"] == ["A walk"]
    assert not idle.get("/v1/clips", params={"q": "turns left"}).json()["items"]
    assert idle.patch(path, json={"captions": None}).json()["captions"] == []
    assert idle.patch(path, json={"captions": ["x"] * 51}).status_code == 422


def test_lists_page_through_everything_once(demo: httpx2.Client) -> None:
    whole = [c["id"] for c in demo.get("/v1/clips", params={"limit": 1000}).json()["items"]]
    seen, cursor = [], None
    while True:
        params = {"limit": 5} | ({"cursor": cursor} if cursor else {})
        page = demo.get("/v1/clips", params=params).json()
        seen += [clip["id"] for clip in page["items"]]
        if (cursor := page["next"]) is None:
            break
    assert seen == whole


@pytest.mark.parametrize(
    ("params", "field", "values"),
    [
        ({"person": "ada"}, "person", {"ada"}),
        ({"task": ["walk", "kick"]}, "task", {"walk", "kick"}),
        ({"state": "ready", "person": "bruno"}, "person", {"bruno"}),
        ({"word": " KICK ", "person": " bruno "}, "task", {"kick"}),
        ({"not_task": ["walk", "kick"], "not_source": "demo"}, "task", {"wave"}),
        ({"not_person": "ada", "not_word": "walk", "not_license": "none"}, "person", {"bruno"}),
    ],
)
def test_lists_are_filtered(
    demo: httpx2.Client, params: dict[str, Any], field: str, values: set[str]
) -> None:
    items = demo.get("/v1/clips", params=params | {"limit": 100}).json()["items"]
    assert {clip[field] for clip in items} == values


def test_lists_are_filtered_by_where_clips_come_from(idle: httpx2.Client) -> None:
    ours = _post(idle, _tiny(61), source=" Studio 4 ").json()["clip"]["id"]
    theirs = _post(idle, _tiny(62), source="a friend").json()["clip"]["id"]

    def found(**filters: Any) -> set[str]:
        items = idle.get("/v1/clips", params=filters | {"limit": 1000}).json()["items"]
        return {clip["id"] for clip in items} & {ours, theirs}

    assert found(source="Studio 4") == {ours}
    assert found(source=["a friend", "Studio 4"]) == {ours, theirs}
    assert found(not_source="a friend") == {ours}
    assert found(source="studio") == set()


def test_lists_name_clips_that_lack_labels(idle: httpx2.Client) -> None:
    source = "lacks labels"
    whole = _post(idle, _tiny(63), source=source, person="eva", task="hop", words="hop")
    nobody = _post(idle, _tiny(64), source=source, task="hop", words="hop")
    ids = {name: sent.json()["clip"]["id"] for name, sent in (("whole", whole), ("no", nobody))}

    def found(**filters: Any) -> set[str]:
        items = idle.get("/v1/clips", params={"source": source} | filters).json()["items"]
        return {clip["id"] for clip in items}

    assert found(missing=["person", "words"]) == {ids["no"]}
    assert found(missing="task") == set()
    assert found(has_warnings=False) == set(ids.values())
    assert found(has_warnings=True) == set()
    assert idle.get("/v1/clips", params={"missing": "name"}).status_code == 422


def test_lists_and_maps_take_every_filter_of_a_search(idle: httpx2.Client) -> None:
    reply = idle.get("/openapi.json").json()
    of_search = set(reply["components"]["schemas"]["Filter"]["properties"])
    assert {"source", "not_source", "license", "max_duration"} <= of_search
    for path in ("/v1/clips", "/v1/space"):
        taken = {one["name"] for one in reply["paths"][path]["get"]["parameters"]}
        assert of_search <= taken
        assert idle.get(path, params={"studio": "4"}).status_code == 422


def test_patch_changes_only_what_is_sent(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    path = f"/v1/clips/{walk['id']}"
    changed = demo.patch(path, json={"source": "elsewhere", "words": ["walk", "slow"]}).json()
    assert changed["source"] == "elsewhere"
    assert changed["words"] == ["walk", "slow"]
    assert changed["person"] == walk["person"]
    back = demo.patch(path, json={"source": walk["source"], "words": walk["words"]}).json()
    assert back == walk


def test_the_file_comes_back_as_an_attachment(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    answer = demo.get(f"/v1/clips/{walk['id']}/file")
    assert hashlib.sha256(answer.content).hexdigest() == walk["sha256"]
    assert answer.headers["content-disposition"].startswith("attachment;")
    assert answer.headers["content-type"] == "application/octet-stream"
    assert answer.headers["x-content-type-options"] == "nosniff"


def test_a_range_of_the_file_can_be_requested(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    path = f"/v1/clips/{walk['id']}/file"
    answer = demo.get(path, headers={"Range": "bytes=4-12"})
    assert (answer.status_code, answer.content) == (206, demo.get(path).content[4:13])


def test_a_file_that_is_deleted_during_downloads(idle: httpx2.Client) -> None:
    content = _tiny(99) + b"\n" * 2**18
    answers: set[int] = set()

    def ask(path: str) -> None:
        for _ in range(30):
            answer = idle.get(path)
            answers.add(answer.status_code)
            assert answer.status_code == 404 or answer.content == content

    for _ in range(5):
        clip = _post(idle, content).json()["clip"]
        with ThreadPoolExecutor(2) as pool:
            asking = [pool.submit(ask, f"/v1/clips/{clip['id']}/file") for _ in range(2)]
            assert idle.delete(f"/v1/clips/{clip['id']}").status_code == 204
            for one in asking:
                one.result()
    assert answers <= {200, 404}


NAMES = ["../../etc/passwd", 'a"b\r\nX-Evil: 1.bvh', "日本.bvh", "..", "\\x", "n\0l.bvh"]


@pytest.mark.parametrize("name", NAMES)
def test_file_names_of_others_do_no_harm(idle: httpx2.Client, name: str) -> None:
    content = _tiny(100 + NAMES.index(name))
    clip = _post(idle, content, name).json()["clip"]
    answer = idle.get(f"/v1/clips/{clip['id']}/file")
    assert answer.content == content
    assert "x-evil" not in answer.headers
    assert "/" not in clip["name"]


def test_motion_as_json_and_as_octets_agree(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    path = f"/v1/clips/{walk['id']}/motion"
    reply = demo.get(path).json()
    assert set(reply) == {"frame_rate", "joint_names", "parents", "positions"}
    positions = np.array(reply["positions"])
    assert positions.shape == (walk["frames"], walk["joints"], 3)
    assert len(reply["joint_names"]) == len(reply["parents"]) == walk["joints"]
    octets = demo.get(path, headers={"Accept": "application/octet-stream"})
    shape = tuple(int(size) for size in octets.headers["x-shape"].split(","))
    raw = np.frombuffer(octets.content, dtype="<f4").reshape(shape)
    np.testing.assert_allclose(raw, positions, atol=1e-6)


def test_motion_is_resampled_and_reduced_to_roles(
    demo: httpx2.Client, walk: dict[str, Any]
) -> None:
    reply = demo.get(f"/v1/clips/{walk['id']}/motion", params={"fps": 10, "joints": "roles"}).json()
    assert reply["frame_rate"] == 10
    assert len(reply["joint_names"]) == 13
    assert len(reply["positions"]) == pytest.approx(walk["duration"] * 10, abs=1)


def test_keyposes_have_curves_and_poses(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = demo.get(f"/v1/clips/{walk['id']}/keyposes", params={"method": "printed"}).json()
    assert reply["method"] == "printed"
    assert len(reply["frames"]) == len(reply["times"]) == len(reply["poses"])
    assert len(reply["energy"]["global"]) == len(reply["energy"]["local"])
    assert np.array(reply["poses"]).reshape(-1, 13, 3).shape[0] == len(reply["frames"])


def test_a_descriptor_has_the_compared_arrays(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = demo.get(f"/v1/clips/{walk['id']}/descriptor").json()
    assert len(reply["motion_vector"]) == 128
    assert len(reply["msv"]["rho"]) == 13
    assert reply["msv"]["lambda"] > 0
    convergence = reply["msv"]["convergence"]
    assert convergence["converged"] is True
    assert len(convergence["errors"]) == len(convergence["changes"]) > 3
    assert 0 < convergence["errors"][-1] <= convergence["errors"][0] < 1
    assert convergence["changes"][-1] < 1e-10 < convergence["changes"][0]
    assert reply["symbol"]["states"] == len(reply["symbol"]["means"])
    assert reply["versions"]["analysis"] >= 1


def test_thumbnail_is_a_picture(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    answer = demo.get(f"/v1/clips/{walk['id']}/thumbnail.svg")
    assert answer.headers["content-type"].startswith("image/svg+xml")
    assert answer.text.startswith("<svg")


def test_a_clip_that_is_not_ready_says_so(idle: httpx2.Client) -> None:
    clip = _post(idle, _tiny(2)).json()["clip"]
    for view in ("motion", "keyposes", "descriptor", "thumbnail.svg"):
        assert_problem(idle.get(f"/v1/clips/{clip['id']}/{view}"), 409, "clip_not_ready")


def test_bad_content_fails_with_its_location(demo_service: Live) -> None:
    bad = next(demo_clips(["dele"], ["walk"], takes=1)).content
    lines = bad.split(b"\n")
    lines[-3] = b"one two three"
    with demo_service.client() as client:
        answer = _post(client, b"\n".join(lines))
        assert answer.status_code == 202
        job = demo_service.wait_for_job(answer.json()["job"]["id"])
        assert job["state"] == "failed"
        clip = client.get(f"/v1/clips/{answer.json()['clip']['id']}").json()
        assert clip["state"] == "failed"
        assert clip["error"]["code"] == "unreadable"
        assert clip["error"]["errors"][0]["location"].startswith("line ")
        again = _post(client, b"\n".join(lines))
        assert again.status_code == 202
        assert again.json()["clip"]["id"] == clip["id"]


def _tiny(salt: int) -> bytes:
    """A small BVH, different for each salt. Nobody analyzes it."""
    return (
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition "
        "Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 1 0\n}\n}\n"
        f"MOTION\nFrames: 1\nFrame Time: 0.01\n{salt} 0 0 0 0 0\n"
    ).encode()


def test_a_symbol_generates_a_motion(demo: httpx2.Client, walk: dict[str, Any]) -> None:
    reply = demo.get(f"/v1/clips/{walk['id']}/symbol/motion").json()
    assert reply["states"] >= 1
    assert len(reply["channels"]) == 26
    frames = len(reply["positions"])
    assert frames / reply["frame_rate"] == pytest.approx(walk["duration"], rel=0.1)
    for channel in reply["channels"]:
        assert len(channel["mean"]) == len(channel["spread"]) == frames
    raw = demo.get(
        f"/v1/clips/{walk['id']}/symbol/motion", headers={"Accept": "application/octet-stream"}
    )
    assert raw.headers["X-Shape"] == f"{frames},13,3"
    assert demo.get("/v1/clips/nobody/symbol/motion").status_code == 404


@pytest.mark.parametrize(
    ("picture", "refused"),
    [("ssm.svg", "time=1000"), ("ssm.svg", "q=3"), ("msv.svg", "slices=1"), ("msv.svg", "eta=-1")],
)
def test_pictures_of_matrices_and_volumes(
    demo: httpx2.Client, walk: dict[str, Any], picture: str, refused: str
) -> None:
    path = f"/v1/clips/{walk['id']}/{picture}"
    drawn = demo.get(path)
    assert drawn.status_code == 200, drawn.text
    assert drawn.headers["content-type"] == "image/svg+xml"
    assert drawn.text.startswith("<svg")
    assert demo.get(f"{path}?q=1&eta=0.5").text != drawn.text
    answer = demo.get(f"{path}?{refused}")
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["location"] == f"query.{refused.split('=')[0]}"
