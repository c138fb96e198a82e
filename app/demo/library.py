"""The demo library: every actor's takes of every task, and a dance to recorded music.

BVH files with a manifest, and WAV files.

Deterministic: the same bytes at every run. Files are in centimeters, Y up.
"""

from __future__ import annotations

import csv
from collections.abc import Collection, Iterator
from itertools import chain
from pathlib import Path

from app.demo.actors import ACTORS, Actor
from app.demo.clip import DemoClip
from app.demo.dances import Sound, dance
from app.demo.performance import Performance
from app.demo.posing import local_rotations
from app.demo.rig import build_rig, skeleton_of
from app.demo.take import enlivened, prepare
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


def demo_clips(
    actors: Collection[str] | None = None,
    tasks: Collection[str] | None = None,
    takes: int = 3,
) -> Iterator[DemoClip]:
    """The clips of the named actors and tasks (all by default), `takes` of each.

    Raises NotFound for an actor or task that the library does not have.
    """
    known = {actor.name: actor for actor in ACTORS}
    _check(actors or (), known, "actor")
    _check(tasks or (), TASKS, "task")
    for actor in ACTORS:
        for task in TASKS:
            if (actors is None or actor.name in actors) and (tasks is None or task in tasks):
                for number in range(1, takes + 1):
                    yield _clip(actor, task, number)


def _check(chosen: Collection[str], known: Collection[str], kind: str) -> None:
    for name in chosen:
        if name not in known:
            raise NotFound(f"the demo library has no {kind} {name!r}, only {', '.join(known)}")


def perform(actor: Actor, task: str, number: int) -> Performance:
    """Take `number` of a task by an actor, as controls, with the small sway of the living."""
    take = prepare(actor, task, number)
    done = TASKS[task](take)
    return Performance(
        done.times, enlivened(done.controls, take, done.times), done.keyposes, done.beats
    )


def _clip(actor: Actor, task: str, number: int) -> DemoClip:
    done = perform(actor, task, number)
    rig = build_rig(actor)
    content = write_bvh(
        skeleton_of(rig, actor.naming, UNITS_PER_METER),
        local_rotations(done.controls, rig),
        done.controls.root * UNITS_PER_METER,
        actor.frame_rate,
    )
    return DemoClip(
        path=f"{actor.name}/{task}_{number:02d}.bvh",
        content=content,
        person=actor.name,
        task=task,
        words=words_for(task, actor.name, number, actor.left_handed),
        frame_rate=actor.frame_rate,
        keyposes=done.keyposes,
        beats=done.beats,
    )


def danced_clips() -> Iterator[DemoClip]:
    """A longer dance of each actor, to music or, for one in three, to a metronome."""
    for number, actor in enumerate(ACTORS, 1):
        yield dance(
            number,
            bpm=actor.beats_per_minute,
            seconds=CHOREOGRAPHY_SECONDS,
            drift=CHOREOGRAPHY_DRIFT,
            actor=actor,
            sound=Sound.MUSIC if number % 3 else Sound.CLICKS,
        )


def write_demo(directory: Path) -> int:
    """Write all clips and their manifest.csv under `directory`; how many clips there are.

    Files that are there already are written over.
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
    keyposes = " ".join(f"{time:.3f}" for time in clip.keyposes)
    offset = "" if clip.audio_offset is None else f"{clip.audio_offset:g}"
    facts = [clip.person, clip.task, " ".join(clip.words), f"{clip.frame_rate:g}", keyposes]
    return [clip.path, SOURCE, LICENSE, *facts, clip.audio_path, offset]
