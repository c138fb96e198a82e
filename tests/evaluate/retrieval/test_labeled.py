"""The query clips, and the clips that are relevant to them."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace

import pytest

from app.errors import BadField, NotEnoughLabels
from app.evaluate.retrieval.labeled import LabeledClips, labeled_among
from app.store.clips.record import ClipRecord


def _clips(like: ClipRecord, *labels: tuple[str, str, str | None]) -> list[ClipRecord]:
    """Clips by (id, file name, task)."""
    return [replace(like, id=i, file_name=name, task=task) for i, name, task in labels]


@pytest.fixture
def some(ready_clips: list[ClipRecord]) -> list[ClipRecord]:
    return _clips(
        ready_clips[0],
        ("a", "walk_1.bvh", "walk"),
        ("b", "walk_2.bvh", "walk"),
        ("c", "walk_2.amc", "walk"),
        ("d", "run_1.bvh", "run"),
        ("e", "run_2.bvh", "run"),
        ("f", "bow_1.bvh", "bow"),
        ("g", "bow_1.amc", "bow"),
        ("h", "dance.bvh", "dance"),
        ("i", "who_knows.bvh", None),
    )


def test_classes_are_tasks_of_two_recordings_the_largest_first(some: list[ClipRecord]) -> None:
    labeled = labeled_among(some)
    assert labeled.classes == ("walk", "run")  # one bow as two files cannot find another
    assert [clip.id for clip in labeled.in_a_class] == list("abcde")
    assert len(labeled.clips) == 8
    assert labeled.unlabeled == 1


def test_copies_of_the_recording_and_unlabeled_clips_are_not_judged(
    some: list[ClipRecord],
) -> None:
    labeled = labeled_among(some)
    judged = labeled.judge(some[1], ["c", "i", "f", "a", "d"], k=20)  # b's own copy is c
    assert judged.precision.tolist() == pytest.approx([0, 1 / 3, 1 / 3])  # f a d are left
    assert judged.average_precision == pytest.approx(1 / 2)
    assert judged.retrieved.tolist() == [1.0, 0.0]  # of a, the first that is of a class


def test_queries_are_drawn_evenly_and_the_same_each_time(ready_clips: list[ClipRecord]) -> None:
    labels = [(f"w{i:02}", f"w{i}.bvh", "walk") for i in range(30)]
    labels += [(f"r{i}", f"r{i}.bvh", "run") for i in range(4)]
    labeled = labeled_among(_clips(ready_clips[0], *labels))
    assert len(labeled.queries(1000)) == 34
    some = labeled.queries(10)
    assert Counter(clip.task for clip in some) == {"walk": 6, "run": 4}
    assert some == labeled.queries(10)
    assert Counter(clip.task for clip in labeled.queries(1)) == {"walk": 1, "run": 1}


def test_the_classes_of_table_1_are_the_given_or_the_largest_ones(some: list[ClipRecord]) -> None:
    labeled = labeled_among(some)
    assert labeled.chosen(None, 1) == ("walk",)
    assert labeled.chosen(["run", "walk", "run"], 4) == ("run", "walk")
    with pytest.raises(BadField, match="'bow', only the tasks walk, run"):
        labeled.chosen(["bow"], 4)


@pytest.mark.parametrize(
    ("tasks", "message"),
    [
        ([], "No two ready clips carry the same task"),
        ([None, None], "No two ready clips carry the same task"),
        (["walk", "run"], "No two ready clips carry the same task"),
        (["walk", "walk"], "All labeled clips carry the task 'walk'"),
    ],
)
def test_clips_that_cannot_be_judged_get_a_clear_message(
    ready_clips: list[ClipRecord], tasks: list[str | None], message: str
) -> None:
    labels = [(str(i), f"{i}.bvh", task) for i, task in enumerate(tasks)]
    with pytest.raises(NotEnoughLabels, match=message):
        labeled_among(_clips(ready_clips[0], *labels))


def test_one_class_among_others_can_be_judged(ready_clips: list[ClipRecord]) -> None:
    labels = [("a", "a.bvh", "walk"), ("b", "b.bvh", "walk"), ("c", "c.bvh", "run")]
    labeled: LabeledClips = labeled_among(_clips(ready_clips[0], *labels))
    assert labeled.classes == ("walk",)
    judged = labeled.judge(labeled.clips[0], ["c", "b"], k=20)
    assert (judged.true_positives, judged.retrieved.tolist()) == (0.0, [1.0])
