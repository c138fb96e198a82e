"""Recordings over HTTP: uploaded with a clip, described, returned, deleted, refused."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import httpx2
import pytest

from app.demo import DemoClip
from app.demo.dances import Sound, dance
from tests.api.conftest import assert_problem
from tests.live import Live


@pytest.fixture(scope="module")
def danced() -> DemoClip:
    return dance(31, bpm=104.0, seconds=12.0, sound=Sound.MUSIC, audio_offset=-0.8)


def _post(client: httpx2.Client, clip: DemoClip, audio: bytes, **said: str) -> httpx2.Response:
    files = {"file": ("d.bvh", clip.content), "audio": ("song.wav", audio)}
    return client.post("/v1/clips", files=files, data=said)


@pytest.fixture(scope="module")
def begun(danced: DemoClip) -> DemoClip:
    """A dance that is small enough for the idle service, which only reads the start of files."""
    return replace(danced, content=danced.content[:50_000], audio=danced.audio[:50_000])


def _ready(service: Live, client: httpx2.Client, reply: dict[str, Any]) -> dict[str, Any]:
    service.wait_for_job(reply["job"]["id"])
    clip: dict[str, Any] = client.get(f"/v1/clips/{reply['clip']['id']}").json()
    assert clip["state"] == "ready", clip["error"]
    return clip


def test_a_recording_gives_beats_and_is_returned(
    demo_service: Live, demo: httpx2.Client, danced: DemoClip
) -> None:
    answer = _post(demo, danced, danced.audio, audio_offset="-0.8")
    assert answer.status_code == 202
    clip = _ready(demo_service, demo, answer.json())
    assert (clip["has_audio"], clip["audio_offset"]) == (True, -0.8)
    keyposes = demo.get(f"/v1/clips/{clip['id']}/keyposes").json()
    assert keyposes["beats_source"] == "audio"
    assert keyposes["beats_confidence"] > 0.9
    assert keyposes["tempo"] == pytest.approx(104.0, rel=0.02)
    sound = demo.get(f"/v1/clips/{clip['id']}/audio")
    assert sound.content == danced.audio
    assert sound.headers["content-disposition"] == 'attachment; filename="song.wav"'
    assert _post(demo, danced, danced.audio).status_code == 200
    gone = demo.delete(f"/v1/clips/{clip['id']}/audio")
    assert (gone.status_code, gone.json()["has_audio"]) == (200, False)
    assert_problem(demo.get(f"/v1/clips/{clip['id']}/audio"), 404, "not_found")
    assert demo.delete(f"/v1/clips/{clip['id']}").status_code == 204


@pytest.mark.parametrize(
    ("field", "value"), [("tempo", "1"), ("tempo", "x"), ("audio_offset", "1e9"), ("beats", "1 x")]
)
def test_bad_fields_of_a_form_are_named(
    idle: httpx2.Client, begun: DemoClip, field: str, value: str
) -> None:
    answer = _post(idle, begun, begun.audio, **{field: value})
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["location"].startswith(f"body.{field}")


def test_a_file_that_is_no_recording_is_refused(idle: httpx2.Client, begun: DemoClip) -> None:
    assert_problem(_post(idle, begun, b"a song"), 422, "bad_field", "body.audio")


def test_a_patch_changes_offset_tempo_and_beats(idle: httpx2.Client, begun: DemoClip) -> None:
    clip = _post(idle, begun, begun.audio, beats="0.5 1.1 1.7").json()["clip"]
    rhythm = {"audio_offset": 0.25, "tempo": 90, "beats": [2.0, 1.0]}
    assert idle.patch(f"/v1/clips/{clip['id']}", json=rhythm).json()["audio_offset"] == 0.25
    bad = idle.patch(f"/v1/clips/{clip['id']}", json={"beats": [-1]})
    assert bad.status_code == 422
