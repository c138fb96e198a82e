"""The files of the demo library are complete and deterministic, and are read like other clips."""

from __future__ import annotations

import csv
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from app.demo import DemoClip, demo_clips, write_demo
from app.demo.actors import ACTORS
from app.demo.tasks import TASKS
from app.errors import NotFound
from app.motion.motion import Motion
from app.motion.roles.joint_roles import JointRole

Clips = dict[tuple[str, str], DemoClip]


def test_every_actor_does_every_task(clips: Clips) -> None:
    assert set(clips) == {(actor.name, task) for actor in ACTORS for task in TASKS}
    assert len(ACTORS) >= 6
    assert len(TASKS) == 8


def test_every_run_gives_the_same_bytes(clips: Clips) -> None:
    def checksum(some: list[DemoClip]) -> str:
        return sha256(b"".join(clip.content for clip in some)).hexdigest()

    some = [clip for clip in clips.values() if clip.person == "chika"]
    assert checksum(list(demo_clips(actors=["chika"], takes=1))) == checksum(some)


def test_takes_differ() -> None:
    contents = {clip.content for clip in demo_clips(["ada"], ["wave", "run"], takes=3)}
    assert len(contents) == 6


def test_clips_are_read_without_cautions(
    clips: Clips, motions: dict[tuple[str, str], Motion]
) -> None:
    rates = {actor.name: actor.frame_rate for actor in ACTORS}
    for key, motion in motions.items():
        assert set(motion.roles) == set(JointRole), key
        assert motion.cautions == (), key
        assert motion.frame_rate == pytest.approx(rates[key[0]]), key
        assert clips[key].frame_rate == rates[key[0]]
        assert motion.metres_per_unit == pytest.approx(0.01), key
        assert 2.5 < motion.duration < 11.0, key


def test_people_have_their_stature(motions: dict[tuple[str, str], Motion]) -> None:
    for actor in ACTORS:
        head = motions[actor.name, "wave"].role_positions()[:, 10, 1]
        assert 0.8 < np.median(head) / actor.body.stature < 0.95


def test_clips_have_two_to_four_words_with_the_task(clips: Clips) -> None:
    for clip in clips.values():
        assert 2 <= len(clip.words) <= 4
        assert clip.task in clip.words
        assert all(" " not in word for word in clip.words)


def test_words_vary_between_takes_and_are_shared_between_people() -> None:
    said = {clip.words for clip in demo_clips(tasks=["walk"], takes=3)}
    assert 1 < len(said) < 18


def test_only_dances_have_beats_and_keyposes(clips: Clips) -> None:
    for clip in clips.values():
        assert bool(clip.beats) == bool(clip.keyposes) == (clip.task == "dance")
        for keypose in clip.keyposes:
            assert min(abs(keypose - beat) for beat in clip.beats) < 1e-9


@pytest.mark.parametrize("wrong", [{"actors": ["nobody"]}, {"tasks": ["swim"]}])
def test_an_unknown_name_is_refused(wrong: dict[str, list[str]]) -> None:
    with pytest.raises(NotFound, match=r"nobody|swim"):
        next(demo_clips(**wrong))


def test_files_and_manifest(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.demo.library.ACTORS", ACTORS[:1])
    assert write_demo(tmp_path / "demo") == 25
    with (tmp_path / "demo" / "manifest.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 25
    for row in rows:
        assert (tmp_path / "demo" / row["path"]).read_bytes().startswith(b"HIERARCHY")
        assert row["license"] == "CC0-1.0"
        assert row["source"] == "Kinedex demo"
        assert row["task"] in row["words"].split()
        assert float(row["fps"]) == ACTORS[0].frame_rate
        assert bool(row["keyposes"]) == ("choreography" in row["path"])
    (recorded,) = (row for row in rows if row["audio"])
    assert (tmp_path / "demo" / recorded["audio"]).read_bytes().startswith(b"RIFF")
    assert -5.0 <= float(recorded["audio_offset"]) <= 1.0
