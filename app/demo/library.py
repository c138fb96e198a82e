"""The demo library: takes of every task by every actor, and a longer dance of each to music.

It consists of BVH files (centimeters, Y up), WAV files and a manifest. It is deterministic: every
run writes the same bytes.
"""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path

from app.demo.actors import ACTORS, Actor
from app.demo.clip import DemoClip
from app.demo.dances import FLOWING, Sound, dance
from app.demo.performance import Performance
from app.demo.posing import local_rotations
from app.demo.rig import build_rig, skeleton_of
from app.demo.take import prepare, with_body_sway
from app.demo.tasks import TASKS
from app.demo.words import words_for
from app.errors import NotFound
from app.formats.bvh.writer import write_bvh

LICENSE = "CC0-1.0"
SOURCE = "Kinedex demo"
UNITS_PER_METER = 100.0
MANIFEST = "manifest.csv"
COLUMNS: tuple[str, ...] = (
    *("path", "source", "license", "person", "task", "words", "fps"),
    *("keyposes", "audio", "audio_offset"),
)
CHOREOGRAPHY_SECONDS, CHOREOGRAPHY_DRIFT = 24.0, 0.02
"""Duration of a longer dance, and the largest relative change of its tempo."""


def demo_clips(
    actors: Collection[str] | None = None,
    tasks: Collection[str] | None = None,
    takes: int = 3,
) -> Iterator[DemoClip]:
    """The clips of the named actors and tasks (all by default), `takes` of each.

    Raises NotFound for an actor or task that the library does not have.
    """
    actor_names = [actor.name for actor in ACTORS]
    _check(actors or (), actor_names, "actor")
    _check(tasks or (), TASKS, "task")
    for actor in ACTORS:
        for task in TASKS:
            if (actors is None or actor.name in actors) and (tasks is None or task in tasks):
                for number in range(1, takes + 1):
                    yield _clip(actor, task, number)


def _check(requested: Collection[str], available: Collection[str], kind: str) -> None:
    for name in requested:
        if name not in available:
            raise NotFound(f"the demo library has no {kind} {name!r}, only {', '.join(available)}")


def perform(actor: Actor, task: str, number: int) -> Performance:
    """Take `number` of a task by an actor, as controls with the small sway of a living body."""
    take = prepare(actor, task, number)
    still = TASKS[task](take)
    return replace(still, controls=with_body_sway(still.controls, take, still.times))


def _clip(actor: Actor, task: str, number: int) -> DemoClip:
    performance = perform(actor, task, number)
    rig = build_rig(actor)
    content = write_bvh(
        skeleton_of(rig, actor.naming, UNITS_PER_METER),
        local_rotations(performance.controls, rig),
        performance.controls.root * UNITS_PER_METER,
        actor.frame_rate,
    )
    return DemoClip(
        path=f"{actor.name}/{task}_{number:02d}.bvh",
        content=content,
        person=actor.name,
        task=task,
        words=words_for(task, actor.name, number, actor.left_handed),
        frame_rate=actor.frame_rate,
        keyposes=performance.keyposes,
        beats=performance.beats,
    )


def danced_clips() -> Iterator[DemoClip]:
    """A longer dance of each actor: two of three to music, every third one to a metronome."""
    for number, actor in enumerate(ACTORS, 1):
        yield dance(
            number,
            bpm=actor.beats_per_minute,
            seconds=CHOREOGRAPHY_SECONDS,
            drift=CHOREOGRAPHY_DRIFT,
            manner=FLOWING,
            actor=actor,
            sound=Sound.MUSIC if number % 3 else Sound.CLICKS,
        )


def write_demo(directory: Path) -> int:
    """Write all clips and their manifest.csv under `directory`; returns the number of clips.

    Existing files are replaced.
    """
    clips = 0
    directory.mkdir(parents=True, exist_ok=True)
    with (directory / MANIFEST).open("w", newline="", encoding="utf-8") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(COLUMNS)
        for clip in chain(demo_clips(), danced_clips()):
            _write(directory / clip.path, clip.content)
            if clip.audio:
                _write(directory / clip.audio_path, clip.audio)
            rows.writerow(_row(clip))
            clips += 1
    return clips


def _write(target: Path, content: bytes) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_bytes(content)


def _row(clip: DemoClip) -> list[str]:
    # The short dances stop at every keypose. Any method finds these, so they would judge nothing.
    named = clip.keyposes if clip.holds else ()
    keyposes = " ".join(f"{time:.3f}" for time in named)
    offset = "" if clip.audio_offset is None else f"{clip.audio_offset:g}"
    labels = [clip.person, clip.task, " ".join(clip.words), f"{clip.frame_rate:g}", keyposes]
    return [clip.path, SOURCE, LICENSE, *labels, clip.audio_path, offset]
