"""Whatever changes a clip, the next search shows the clip as it is: no kept text is out of date."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Iterator
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip, demo_clips
from app.demo.dances import Sound, dance
from tests.live import Live, serve

FILES = list(demo_clips(("ada",), ("walk", "kick"), takes=2))
ROUNDS = 5
"""How often a clip may change between two calls that are compared."""


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    with serve(tmp_path_factory.mktemp("shown") / "data", worker=True) as service:
        for clip in FILES:
            service.wait_for_job(service.upload(clip).json()["job"]["id"])
        yield service


@pytest.fixture
def client(live: Live) -> Iterator[httpx2.Client]:
    with live.client() as opened:
        yield opened


def _is_shown(client: httpx2.Client) -> list[dict[str, Any]]:
    """Searches show all clips as they are; returns the clips."""
    clip_id = client.get("/v1/clips", params={"limit": 1, "state": "ready"}).json()["items"][0][
        "id"
    ]
    for kind, body in (
        ("motion", {"clip_id": clip_id}),
        ("motion", {"clip_id": clip_id}),
        ("pose", {"clip_id": clip_id, "time": 0.5}),
    ):
        for _ in range(ROUNDS):
            asked = {**body, "limit": 100, "include_self": True}
            before = _listed(client)
            hits = client.post(f"/v1/search/{kind}", json=asked).json()["items"]
            found = {hit["clip"]["id"]: hit["clip"] for hit in hits}
            if before == _listed(client):  # the worker has changed nothing meanwhile
                break
        assert found == before
    return list(found.values())


def _listed(client: httpx2.Client) -> dict[str, dict[str, Any]]:
    items = client.get("/v1/clips", params={"limit": 100, "state": "ready"}).json()["items"]
    return {clip["id"]: clip for clip in items}


def _clip(client: httpx2.Client, task: str = "walk") -> dict[str, Any]:
    return next(clip for clip in _is_shown(client) if clip["task"] == task and not clip["origin"])


def _finish(live: Live, client: httpx2.Client, answer: httpx2.Response) -> None:
    """Compare the clips until the work that an answer tells of is done."""
    assert answer.status_code in (200, 202), answer.text
    _is_shown(client)
    for job in client.get("/v1/jobs", params={"limit": 100}).json()["items"]:
        live.wait_for_job(job["id"])
    _is_shown(client)


@pytest.mark.parametrize(
    ("sent", "shown"),
    [
        ({"name": "another name"}, None),
        ({"person": "cleo"}, None),
        ({"words": ["slow", "left_leg"]}, None),
        ({"captions": ["Somebody walks."]}, None),
        ({"license": "CC0-1.0"}, None),
        ({"source": "a lab"}, None),
        ({"metadata": {"age": 30, "site": "x"}}, None),
        ({"metadata": {"age": None}}, {"metadata": {"site": "x"}}),
        ({"captions": None, "words": None, "person": None}, None),
    ],
    ids=str,
)
def test_corrections(
    client: httpx2.Client, sent: dict[str, Any], shown: dict[str, Any] | None
) -> None:
    clip = _clip(client)
    assert client.patch(f"/v1/clips/{clip['id']}", json=sent).status_code == 200
    now = next(one for one in _is_shown(client) if one["id"] == clip["id"])
    expected = shown or {
        name: value or ([] if name != "person" else None) for name, value in sent.items()
    }
    assert {name: now[name] for name in expected} == expected


def test_hints_that_need_a_new_analysis(live: Live, client: httpx2.Client) -> None:
    clip = _clip(client)
    frame_rate = 2.0 * clip["frame_rate"]
    answer = client.patch(f"/v1/clips/{clip['id']}", json={"frame_rate": frame_rate})
    _finish(live, client, answer)
    assert next(one for one in _listed(client).values() if one["id"] == clip["id"])[
        "frame_rate"
    ] == pytest.approx(frame_rate)
    answer = client.patch(f"/v1/clips/{clip['id']}", json={"roles": {"head": "no such joint"}})
    if answer.status_code == 200:  # the analysis fails, and the clip keeps the one before
        _finish(live, client, answer)


def test_the_same_file_with_other_labels(live: Live, client: httpx2.Client) -> None:
    _is_shown(client)
    answer = live.upload(FILES[0], on_conflict="update", license="CC-BY-4.0", name="again")
    assert answer.status_code == 200
    assert "again" in {clip["name"] for clip in _is_shown(client)}


def test_an_import_with_a_manifest(live: Live, client: httpx2.Client) -> None:
    for person in ("dora", "emil"):
        _is_shown(client)
        _finish(live, client, _import(client, FILES[3], f"path,person\na.bvh,{person}\n"))
        assert person in {clip["person"] for clip in _is_shown(client)}


def _import(client: httpx2.Client, clip: DemoClip, manifest: str) -> httpx2.Response:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr("manifest.csv", manifest)
        archive.writestr("a.bvh", clip.content)
    return client.post("/v1/imports", files={"archive": ("a.zip", content.getvalue())})


def test_recordings(live: Live, client: httpx2.Client) -> None:
    danced = dance(31, bpm=104.0, seconds=12.0, sound=Sound.MUSIC, audio_offset=-0.8)
    for audio in (None, danced.audio):  # the second time, the clip gets its recording
        files = {"file": ("d.bvh", danced.content)} | ({"audio": ("a.wav", audio)} if audio else {})
        _finish(live, client, client.post("/v1/clips", files=files, data={"task": "dance"}))
    clip = _clip(client, "dance")
    assert clip["has_audio"]
    client.patch(f"/v1/clips/{clip['id']}", json={"audio_offset": 0.25})
    _is_shown(client)
    _finish(live, client, client.delete(f"/v1/clips/{clip['id']}/audio"))
    assert not _clip(client, "dance")["has_audio"]


def test_what_is_said_beside_a_clip(client: httpx2.Client) -> None:
    path = f"/v1/clips/{_clip(client)['id']}"
    one = {"start": 0.1, "end": 0.5, "words": ["step"]}
    assert client.put(f"{path}/annotations", json={"items": [one]}).status_code == 200
    _is_shown(client)
    assert client.put(f"{path}/keyposes", json={"times": [0.25, 0.5]}).status_code == 200
    _is_shown(client)
    tree = {"parents": {"walk": "locomotion"}}
    assert client.put("/v1/labels/tree", json=tree).status_code == 200
    _is_shown(client)


def test_a_copy_whose_original_is_deleted(live: Live, client: httpx2.Client) -> None:
    clip = _clip(client, "kick")
    steps = {"steps": [{"kind": "resample", "fps": 24}]}
    first = client.post(f"/v1/clips/{clip['id']}/edits", json=steps)
    _finish(live, client, first)
    original = first.json()["clip"]["id"]
    _finish(
        live,
        client,
        client.post(f"/v1/clips/{original}/edits", json={"steps": [{"kind": "mirror"}]}),
    )
    assert client.delete(f"/v1/clips/{original}").status_code == 204
    assert [clip["origin"]["deleted"] for clip in _is_shown(client) if clip["origin"]] == [True]


def test_a_person_who_is_forgotten(client: httpx2.Client) -> None:
    clip = _clip(client)
    client.patch(f"/v1/clips/{clip['id']}", json={"person": "fritz", "name": "fritz walks"})
    assert "fritz walks" in json.dumps(_is_shown(client))
    assert client.delete("/v1/persons/fritz").status_code in (200, 204)
    assert "fritz" not in json.dumps(_is_shown(client))
