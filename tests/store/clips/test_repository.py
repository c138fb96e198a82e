"""Clips: one row for each content; states, labels and deletion."""

from __future__ import annotations

import multiprocessing
from datetime import UTC
from multiprocessing.synchronize import Barrier
from pathlib import Path

import numpy as np
import pytest
from sqlalchemy import update

from app.errors import ClipNotFound
from app.store.clips import arrays, labels
from app.store.clips import repository as clips
from app.store.clips import versions as library
from app.store.clips.labels import CountBySource
from app.store.clips.record import (
    AddOutcome,
    AnalysisHints,
    AttachedAudio,
    ClipState,
    ClipWarning,
)
from app.store.database import tables as t
from app.store.store import Store
from tests.store.conftest import AddClip, facts, new_clip
from tests.store.stored_arrays import array_versions

HINTS = AnalysisHints(
    frame_rate=60.0,
    metres_per_unit=0.01,
    roles={"hips": "Root"},
    stack="Take 001",
    audio_offset=-1.5,
    tempo=98.0,
    beats=(0.5, 1.1),
)


def test_a_new_clip_is_read_as_it_was_added(store: Store) -> None:
    new = new_clip(
        "Größe",
        person="anna",
        task="walk",
        words=("walk", "left_leg", "walk"),
        license="CC0-1.0",
        source="lab",
        hints=HINTS,
        audio=AttachedAudio("c" * 64, "song.mp3", 7),
    )
    with store.write() as tx:
        added = clips.add_or_get(tx, new)
    with store.read() as tx:
        clip = clips.get(tx, added.clip.id)
    assert clip == added.clip
    assert added.needs_analysis
    assert (clip.name, clip.person, clip.task, clip.license) == ("Größe", "anna", "walk", "CC0-1.0")
    assert clip.words == ("walk", "left_leg")
    assert clip.state is ClipState.QUEUED
    assert clip.hints == HINTS
    assert clip.audio == AttachedAudio("c" * 64, "song.mp3", 7)
    assert clip.analysis_input == (HINTS, "c" * 64)
    assert (clip.audio_offset, clip.audio_begins_at) == (None, -1.5)
    assert clip.created_at.tzinfo is UTC
    assert (clip.frames, clip.roles, clip.warnings, clip.error) == (None, {}, (), None)


def test_the_same_content_is_one_clip(store: Store, add_clip: AddClip) -> None:
    first = add_clip("walk", ready=True)
    with store.write() as tx:
        again = clips.add_or_get(tx, new_clip("walk", person="someone else"))
    assert again.outcome is AddOutcome.EXISTS
    assert not again.needs_analysis
    assert again.clip == first


def test_the_same_file_with_another_skeleton_is_another_clip(store: Store) -> None:
    with store.write() as tx:
        added = [
            clips.add_or_get(tx, new_clip("amc", skeleton_sha256=skeleton)).clip
            for skeleton in (None, "a" * 64, "b" * 64, "a" * 64)
        ]
    assert len({clip.id for clip in added}) == 3
    assert added[1].id == added[3].id
    assert len({clip.sha256 for clip in added}) == 1


def test_a_failed_clip_is_queued_again_with_the_new_labels(store: Store, add_clip: AddClip) -> None:
    clip = add_clip("walk", person="anna", words=("walk",))
    with store.write() as tx:
        clips.set_failed(tx, clip.id, {"code": "unreadable"})
        again = clips.add_or_get(
            tx, new_clip("walk", task="run", hints=AnalysisHints(metres_per_unit=0.01))
        )
    assert again.outcome is AddOutcome.REQUEUED
    assert again.clip.id == clip.id
    assert again.clip.state is ClipState.QUEUED
    assert again.clip.error is None
    assert (again.clip.person, again.clip.task, again.clip.words) == ("anna", "run", ("walk",))
    assert again.clip.hints.metres_per_unit == 0.01


def test_a_ready_clip_has_the_facts_of_its_analysis(add_clip: AddClip) -> None:
    clip = add_clip("walk", ready=True)
    found = facts()
    assert clip.state is ClipState.READY
    assert clip.warnings == found.warnings
    assert clip.missing_roles == found.missing_roles
    assert (clip.frames, clip.duration, clip.joints, clip.format) == (90, 3.0, 22, "bvh")
    assert clip.start_offset == 1.25


def test_patch_changes_only_the_given_fields(store: Store, add_clip: AddClip) -> None:
    clip = add_clip("walk", person="anna", task="walk", words=("walk", "slow"))
    with store.write() as tx:
        changed = clips.patch(tx, clip.id, {"name": "New", "task": None, "words": ["run"]})
    assert (changed.name, changed.person, changed.task) == ("New", "anna", None)
    assert changed.words == ("run",)
    with store.read() as tx:
        assert labels.words(tx, "us") == (CountBySource("run", 1, 0),)


@pytest.mark.parametrize("act", ["get", "patch", "requeue", "delete_clip"])
def test_unknown_ids(store: Store, act: str) -> None:
    arguments: tuple[object, ...] = ({},) if act == "patch" else ()
    with pytest.raises(ClipNotFound, match="nobody"), store.write() as tx:
        getattr(clips, act)(tx, "nobody", *arguments)


def test_deleting_a_clip_deletes_its_words_and_arrays(store: Store, add_clip: AddClip) -> None:
    clip, other = add_clip("walk", words=("walk",)), add_clip("run", words=("run",))
    with store.write() as tx:
        for each in (clip, other):
            arrays.put_many(tx, each.id, {"v": np.zeros(3)}, version=1)
        assert clips.delete_clip(tx, clip.id) == clip
        assert labels.words(tx, "us") == (CountBySource("run", 1, 0),)
        assert array_versions(tx, clip.id) == {}
        assert set(arrays.get_many(tx, [clip.id, other.id], "v")) == {other.id}


def test_get_many_keeps_the_order_and_leaves_out_unknown_clips(
    store: Store, add_clip: AddClip, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clips, "IDS_PER_QUERY", 2)
    ids = [add_clip(name, words=(name,)).id for name in "abcde"]
    asked = [ids[4], "nobody", ids[0], ids[2]]
    with store.read() as tx:
        found = clips.get_many(tx, asked)
    assert list(found) == [ids[4], ids[0], ids[2]]
    assert [clip.words for clip in found.values()] == [("e",), ("a",), ("c",)]


def test_labels_are_counted(store: Store, add_clip: AddClip) -> None:
    add_clip("1", person="anna", task="walk", words=("walk", "slow"))
    add_clip("2", person="anna", words=("walk",), source="us")
    add_clip("3", person="ben", source="them")
    add_clip("4")
    with store.read() as tx:
        assert labels.persons(tx, "us") == (CountBySource("anna", 1, 1), CountBySource("ben", 1, 0))
        assert labels.tasks(tx, "us") == (CountBySource("walk", 1, 0),)
        assert labels.words(tx, "us") == (CountBySource("slow", 1, 0), CountBySource("walk", 1, 1))
        assert labels.person_names(tx) == {"anna", "ben"}


def _add_the_same(url: str, directory: Path, barrier: Barrier) -> None:
    store = Store.open(url, directory)
    for number in range(10):
        barrier.wait(300)
        with store.write() as tx:
            clips.add_or_get(tx, new_clip(f"clip {number}"))
    store.close()


def test_processes_that_add_the_same_content_make_one_clip(
    store: Store, database_url: str, tmp_path: Path
) -> None:
    spawn = multiprocessing.get_context("spawn")
    barrier = spawn.Barrier(2)
    arguments = (database_url, tmp_path, barrier)
    processes = [spawn.Process(target=_add_the_same, args=arguments) for _ in range(2)]
    for process in processes:
        process.start()
    for process in processes:
        process.join(300)
    assert [process.exitcode for process in processes] == [0, 0]
    with store.read() as tx:
        for number in range(10):
            assert clips.find_by_content(tx, new_clip(f"clip {number}").content_key)
        assert library.version(tx) == 0


def test_warnings_from_before_they_had_places_are_read(store: Store, add_clip: AddClip) -> None:
    clip_id = add_clip("old").id
    old = [{"code": "gaps_filled", "detail": "Some.", "likely": None}]
    with store.write() as tx:
        tx.execute(update(t.clips).where(t.clips.c.id == clip_id).values(warnings=old))
    with store.read() as tx:
        (warning,) = clips.get(tx, clip_id).warnings
    assert warning == ClipWarning("gaps_filled", "Some.")
    assert (warning.start, warning.end, warning.joint) == (None, None, None)
