"""Rounds: the held-out clips are never in the training data."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import NotEnoughLabels
from app.evaluate.recognition.clips import JudgedClips
from app.evaluate.recognition.rounds import (
    DRAWS,
    MAX_ROUNDS,
    LeftOut,
    rounds,
    rounds_by_recording,
    rounds_by_takes,
)
from tests.evaluate.recognition.recognition_library import invented, some


@pytest.mark.parametrize("left_out", LeftOut)
def test_no_probe_is_in_the_training_data(left_out: LeftOut) -> None:
    clips = invented(sources=2)
    for one in rounds(clips, left_out):
        recordings = [{clips.groups[i] for i in part.tolist()} for part in (one.train, one.probe)]
        assert not recordings[0] & recordings[1]


def test_each_take_is_left_out_once_and_no_label_completely() -> None:
    clips = invented()
    found = rounds(clips, LeftOut.TAKE)
    assert sorted(np.concatenate([one.probe for one in found]).tolist()) == list(range(len(clips)))
    for one in found:
        for labels in (clips.persons, clips.tasks):
            assert {labels[i] for i in one.train.tolist()} == set(labels)


def test_labels_with_two_recordings_stay_in_the_training_data() -> None:
    clips = some(invented(), np.arange(70, 120))
    rare = [7, 33]
    clips = replace(clips, tasks=["rare" if i in rare else t for i, t in enumerate(clips.tasks)])
    for one in rounds(clips, LeftOut.TAKE):
        assert len(set(rare) & set(one.probe.tolist())) < 2


@pytest.mark.parametrize("factor", ["person", "task"])
def test_all_clips_of_a_label_are_left_out_and_known_labels_are_probed(factor: str) -> None:
    clips = invented()
    labels = clips.labels(factor)
    found = rounds(clips, LeftOut(factor))
    assert [one.left_out for one in found] == [(name,) for name in sorted(set(labels))]  # type: ignore[type-var]
    for one in found:
        assert one.left_out[0] not in {labels[i] for i in one.train.tolist()}
        asked = Counter(labels[i] for i in one.probe.tolist())
        assert asked[one.left_out[0]] == labels.count(one.left_out[0])
        assert len(asked) > 1


def test_many_labels_are_left_out_in_groups() -> None:
    clips = invented(persons=MAX_ROUNDS + 5, tasks=2, takes=2)
    found = rounds(clips, LeftOut.PERSON)
    assert len(found) == MAX_ROUNDS
    assert sum(len(one.left_out) for one in found) == MAX_ROUNDS + 5


def test_all_clips_of_one_source_are_left_out() -> None:
    clips = invented(sources=3)
    for one in rounds(clips, LeftOut.SOURCE):
        assert {clips.sources[i] for i in one.probe.tolist()} == set(one.left_out)
        assert len(one.train) + len(one.probe) == len(clips)


@given(takes=st.integers(1, 3), seed=st.integers(0, 20))
def test_the_given_number_of_takes_of_each_cell_is_learned(takes: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    clips = some(invented(), np.sort(rng.choice(120, 90, replace=False)))
    sizes = Counter(zip(clips.persons, clips.tasks, strict=True))
    for one in rounds_by_takes(clips, takes):
        learned = Counter((clips.persons[i], clips.tasks[i]) for i in one.train.tolist())
        asked = Counter((clips.persons[i], clips.tasks[i]) for i in one.probe.tolist())
        assert set(learned.values()) == {takes}
        assert set(learned) == set(asked) == {cell for cell, size in sizes.items() if size > takes}
        assert all(learned[cell] + asked[cell] == sizes[cell] for cell in learned)


def test_two_files_of_a_recording_are_one_take() -> None:
    clips = invented(persons=2, tasks=2, takes=2)
    twice = some(clips, np.repeat(np.arange(len(clips)), 2))
    found = rounds_by_takes(twice, 1)
    assert len(found) == DRAWS
    assert [len(one.train) for one in found] == [8] * DRAWS
    with pytest.raises(NotEnoughLabels, match="with 3 takes each"):
        rounds_by_takes(twice, 2)


def test_draws_differ_and_are_deterministic() -> None:
    clips = invented()
    first, again = rounds_by_takes(clips, 1), rounds_by_takes(clips, 1)
    assert all((a.train == b.train).all() for a, b in zip(first, again, strict=True))
    assert len({tuple(one.train.tolist()) for one in first}) == DRAWS


def test_each_recording_is_left_out_alone_if_there_are_few() -> None:
    clips = invented(persons=2, tasks=3, takes=2)
    alone = sorted(one.probe.tolist() for one in rounds_by_recording(clips))
    assert alone == [[i] for i in range(12)]
    assert len(rounds_by_recording(invented())) == MAX_ROUNDS


@pytest.mark.parametrize(
    ("left_out", "clips", "expected"),
    [
        (LeftOut.PERSON, invented(persons=2), "3 persons are needed to leave one out; there are 2"),
        (LeftOut.TASK, invented(tasks=1), "3 tasks are needed to leave one out; there are 1"),
        (LeftOut.SOURCE, invented(), "Two sources are needed"),
        (LeftOut.TAKE, invented(1, 1, 2), "too few recordings"),
    ],
)
def test_too_few_labels_get_a_clear_message(
    left_out: LeftOut, clips: JudgedClips, expected: str
) -> None:
    with pytest.raises(NotEnoughLabels, match=expected):
        rounds(clips, left_out)
