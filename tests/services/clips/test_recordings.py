"""Recordings of clips: stored, analyzed, replaced, removed. Beats of a client go first."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile

from app.demo import DemoClip
from app.demo.dances import Sound, dance
from app.errors import BadField, NotFound
from app.services.clips import catalogue as clips
from app.services.clips.catalogue import Created
from app.services.clips.recordings import NewRecording
from app.services.imports import imports
from app.services.library.analysis_pool import AnalysisRequest, analyze_file
from app.services.library.library import Library, ingest_limits
from app.services.views import keyposes
from app.store.clips.record import ClipRecord, ClipState, Reanalysis
from app.store.jobs import import_files
from app.store.upkeep.sweep import SweepReport, sweep
from tests.libraries import work


@pytest.fixture(scope="module")
def danced() -> DemoClip:
    """A dance to music, in which the recording begins 1.3 s before the motion."""
    return dance(21, bpm=100.0, seconds=14.0, sound=Sound.MUSIC, audio_offset=-1.3)


def send(lib: Library, clip: DemoClip, audio: bytes | None, **said: Any) -> Created:
    recording = None if audio is None else NewRecording(io.BytesIO(audio), "../song.wav")
    return clips.create_clip(lib, io.BytesIO(clip.content), "a.bvh", said, recording=recording)


def ready(lib: Library, created: Created) -> ClipRecord:
    work(lib.settings)
    clip = clips.get_clip(lib, created.clip.id)
    assert clip.state is ClipState.READY, clip.error
    return clip


def codes(clip: ClipRecord) -> set[str]:
    return {warning.code for warning in clip.warnings}


def as_format(wav: bytes, format: str) -> bytes:
    samples, rate = soundfile.read(io.BytesIO(wav))
    file = io.BytesIO()
    soundfile.write(file, samples, rate, format=format)
    return file.getvalue()


@pytest.mark.parametrize("format", ["WAV", "FLAC", "OGG", "MP3"])
def test_the_beats_of_a_recording_become_those_of_the_motion(
    lib: Library, danced: DemoClip, format: str
) -> None:
    clip = ready(lib, send(lib, danced, as_format(danced.audio, format), audio_offset=-1.3))
    found = keyposes.view(lib, clip.id).found
    assert found.beats.source == "audio"
    assert clip.audio_offset == -1.3
    beats = np.array(danced.beats)
    assert np.abs(beats[:, None] - found.beats.times).min(axis=1).max() < 0.08
    assert codes(clip) == set()


@pytest.mark.parametrize("format", ["WAV", "MP3"])
def test_a_truncated_recording_gives_a_warning(lib: Library, danced: DemoClip, format: str) -> None:
    whole = as_format(danced.audio, format)
    clip = ready(lib, send(lib, danced, whole[:2000], audio_offset=-1.3))
    warnings = {warning.code: warning.detail for warning in clip.warnings}
    assert list(warnings) == ["audio_truncated", "audio_without_beats"]
    assert "is cut off: its header promises" in warnings["audio_truncated"]
    if format == "WAV":
        assert f"promises {len(whole)} bytes, 2000 are there" in warnings["audio_truncated"]


def test_a_decoder_writes_nothing_to_the_log(
    lib: Library, danced: DemoClip, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    song = tmp_path / "song.mp3"
    song.write_bytes(as_format(danced.audio, "MP3")[:2000])
    request = AnalysisRequest(content=danced.content, audio_path=str(song))
    found = analyze_file(request, ingest_limits(lib.settings))  # in this process
    assert "audio_truncated" in {caution.code for caution in found.cautions}
    assert capfd.readouterr() == ("", "")


def test_a_missing_offset_is_estimated_with_a_warning(lib: Library, danced: DemoClip) -> None:
    clip = ready(lib, send(lib, danced, danced.audio))
    beats, found = np.array(danced.beats), keyposes.view(lib, clip.id).found.beats
    assert found.source == "audio"
    assert np.median(np.abs(beats[:, None] - found.times).min(axis=1)) < 0.05
    assert codes(clip) == {"audio_offset_estimated"}
    assert "wrong by whole beats of 0.60 s" in clip.warnings[0].detail
    assert clip.audio_offset is not None
    off = (clip.audio_offset + 1.3) / 0.6
    assert abs(off - round(off)) < 0.15  # right, but for whole beats


def test_the_clients_beats_replace_those_of_the_recording(lib: Library, danced: DemoClip) -> None:
    sent = send(lib, danced, danced.audio, tempo="50", beats=[3.0, 1.0, 2.0], audio_offset=-1.3)
    clip = ready(lib, sent)
    found = keyposes.view(lib, clip.id).found.beats
    assert (found.source, found.times.tolist()) == ("given", [1.0, 2.0, 3.0])
    clips.update_clip(lib, clip.id, {"beats": None})
    found = keyposes.view(lib, ready(lib, sent).id).found.beats
    assert (found.source, found.tempo) == ("tempo", 50.0)
    assert np.median(np.diff(found.times)) == pytest.approx(1.2, abs=0.05)
    clips.update_clip(lib, clip.id, {"tempo": None})
    assert keyposes.view(lib, ready(lib, sent).id).found.beats.source == "audio"
    assert clips.remove_recording(lib, clip.id).reanalysis is Reanalysis.QUEUED
    clip = ready(lib, sent)
    assert keyposes.view(lib, clip.id).found.beats.source == "motion"
    assert clip.audio_offset is None


def test_the_same_motion_with_another_recording_gets_the_new_recording(
    lib: Library, danced: DemoClip
) -> None:
    first = send(lib, danced, None)
    ready(lib, first)
    with_sound = send(lib, danced, danced.audio, audio_offset=-1.3, person="not taken")
    assert (with_sound.is_new, with_sound.clip.id) == (True, first.clip.id)
    clip = ready(lib, with_sound)
    assert (clip.audio_offset, clip.person) == (-1.3, None)
    assert send(lib, danced, danced.audio).job is None
    assert send(lib, danced, None).job is None
    old = clips.open_recording(lib, clip.id).path
    other = dance(22, seconds=8.0, sound=Sound.CLICKS).audio
    send(lib, danced, other)
    held = clips.open_recording(lib, clip.id)
    assert (held.path.read_bytes(), held.name, held.size) == (other, "song.wav", len(other))
    assert not old.exists()


def test_a_recording_is_removed_with_the_last_clip_that_has_it(
    lib: Library, danced: DemoClip
) -> None:
    another = dance(22, seconds=8.0)
    one, two = send(lib, danced, danced.audio), send(lib, another, danced.audio)
    path = clips.open_recording(lib, one.clip.id).path
    clips.delete_clip(lib, one.clip.id)
    assert path.exists()
    assert sweep(lib.store, 30) == SweepReport()
    clips.delete_clip(lib, two.clip.id)
    assert not path.exists()


def test_a_file_that_is_no_recording_is_refused_at_upload(lib: Library, danced: DemoClip) -> None:
    for bad in (b"", b"HIERARCHY", danced.content):
        with pytest.raises(BadField) as refused:
            send(lib, danced, bad)
        assert refused.value.places[0].location == "audio"
    assert list(lib.store.files) == []


@pytest.mark.parametrize(
    ("audio", "code"),
    [
        (b"fLaC" + bytes(200), "audio_unreadable"),
        (as_format(dance(22, seconds=4.0, sound=Sound.CLICKS).audio, "WAV")[:60], None),
    ],
)
def test_a_clip_with_an_unusable_recording_becomes_ready(
    lib: Library, danced: DemoClip, audio: bytes, code: str | None
) -> None:
    clip = ready(lib, send(lib, danced, audio))
    assert codes(clip) & {"audio_unreadable", "audio_without_beats"}
    assert code is None or codes(clip) == {code}
    assert keyposes.view(lib, clip.id).found.beats.source == "motion"


@pytest.mark.parametrize(
    ("field", "value"),
    [("tempo", 5), ("tempo", "fast"), ("audio_offset", 1e9), ("beats", "1 x"), ("beats", [-1.0])],
)
def test_bad_fields_are_named(lib: Library, danced: DemoClip, field: str, value: Any) -> None:
    with pytest.raises(BadField) as refused:
        send(lib, danced, None, **{field: value})
    assert refused.value.places[0].location == field


def test_a_clip_without_a_recording_gives_a_clear_error(lib: Library, danced: DemoClip) -> None:
    clip_id = send(lib, danced, None).clip.id
    for ask in (clips.open_recording, clips.remove_recording):
        with pytest.raises(NotFound, match="no recording"):
            ask(lib, clip_id)


def test_a_manifest_names_recordings(lib: Library, danced: DemoClip) -> None:
    archive = io.BytesIO()
    rows = (
        "path,audio,audio_offset,tempo,beats\n"
        "one.bvh,sound/one.wav,-1.3,,\n"
        "two.bvh,sound/gone.wav,,,0.5 1.0 1.5\n"
    )
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("in/manifest.csv", rows)
        file.writestr("in/one.bvh", danced.content)
        file.writestr("in/two.bvh", dance(22, seconds=8.0).content)
        file.writestr("in/sound/one.wav", danced.audio)
    job = imports.start_import(lib, io.BytesIO(archive.getvalue()), "in.zip")
    work(lib.settings)
    with lib.store.read() as tx:
        entries = {entry.path: entry for entry in import_files.page(tx, job.id).items}
    assert set(entries) == {"in/one.bvh", "in/two.bvh", "in/sound/gone.wav"}
    gone = entries["in/sound/gone.wav"].error
    assert gone is not None
    assert gone["errors"][0]["location"] == "manifest.csv line 3"
    one, two = (clips.get_clip(lib, str(entries[f"in/{n}.bvh"].clip_id)) for n in ("one", "two"))
    assert (one.state, one.audio_offset, one.audio and one.audio.name) == (
        ClipState.READY,
        -1.3,
        "one.wav",
    )
    assert keyposes.view(lib, one.id).found.beats.source == "audio"
    assert keyposes.view(lib, two.id).found.beats.times.tolist() == [0.5, 1.0, 1.5]
