from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.recognition.perera import (
    TensorRecognizer,
    fit_tensor_recognizer,
    poses_of,
    recognize_by_tensor,
)
from app.numerics.arrays import FloatArray
from tests.models.danced import danced_by


class Clips:
    """Motion samples of invented dancers, some of which were never recorded."""

    def __init__(self, *, without: tuple[str | None, str | None] = (None, None)) -> None:
        danced = danced_by(5, 6, 4)
        self.samples = _samples(danced.poses)
        self.persons, self.tasks = danced.persons, danced.tasks
        self.train = np.array(
            [
                cycle > 0 and person != without[0] and task != without[1]
                for person, task, cycle in zip(
                    danced.persons, danced.tasks, danced.cycle, strict=True
                )
            ]
        )
        self.probe = danced.cycle == 0

    def fit(self) -> TensorRecognizer:
        index = np.flatnonzero(self.train)
        who, what = ([names[i] for i in index] for names in (self.persons, self.tasks))
        return fit_tensor_recognizer(self.samples[index], who, what)


def _samples(poses: FloatArray) -> FloatArray:
    return np.hstack([poses.reshape(len(poses), -1), np.zeros((len(poses), 2))])


@pytest.fixture(scope="module")
def clips() -> Clips:
    return Clips()


@pytest.fixture(scope="module")
def record(clips: Clips) -> TensorRecognizer:
    return clips.fit()


def test_the_poses_of_a_sample_are_all_but_its_turn_and_speed(clips: Clips) -> None:
    poses = danced_by(5, 6, 4).poses
    np.testing.assert_array_equal(poses_of(_samples(poses)), poses)


@pytest.mark.parametrize("told", ["person", "task", "nothing"])
def test_held_out_takes_are_recognized(clips: Clips, record: TensorRecognizer, told: str) -> None:
    for i in np.flatnonzero(clips.probe)[::3]:
        who, what = clips.persons[i], clips.tasks[i]
        (found,) = recognize_by_tensor(
            record,
            clips.samples[[i]],
            known_person=who if told == "person" else None,
            known_task=what if told == "task" else None,
        )
        assert (found.person.label, found.task.label) == (who, what)
        for answer in (found.person, found.task):
            scores = [candidate.score for candidate in answer.candidates]
            assert scores == sorted(scores, reverse=True)
            assert sum(scores) <= 1 + 1e-9


@pytest.mark.parametrize("factor", ["person", "task"])
def test_a_new_person_and_a_new_task_are_unknown(factor: str) -> None:
    clips = Clips(without=("p2", None) if factor == "person" else (None, "t3"))
    record = clips.fit()
    labels = clips.persons if factor == "person" else clips.tasks
    new = np.array([label in ("p2", "t3") for label in labels])
    strange = recognize_by_tensor(record, clips.samples[new])
    usual = recognize_by_tensor(record, clips.samples[clips.probe & ~new])
    assert np.mean([not getattr(f, factor).known for f in strange]) > 0.8
    assert np.mean([getattr(f, factor).known for f in usual]) > 0.8
    assert all(getattr(f, factor).label is None for f in strange if not getattr(f, factor).known)


def test_a_stricter_rate_accepts_less(clips: Clips, record: TensorRecognizer) -> None:
    strict = record.accepting(0.001)
    assert strict.task_calibration.error_rates()[0] == 0.0
    assert strict.task_calibration.threshold <= record.task_calibration.threshold


def test_labels_that_the_library_lacks_are_ignored(clips: Clips, record: TensorRecognizer) -> None:
    (plain,) = recognize_by_tensor(record, clips.samples[:1])
    (told,) = recognize_by_tensor(record, clips.samples[:1], known_person="nobody")
    assert told.task == plain.task
    assert told.person.label is None


def test_a_record_comes_back_from_its_arrays(clips: Clips, record: TensorRecognizer) -> None:
    arrays, meta = record.to_arrays()
    again = TensorRecognizer.from_arrays(arrays, json.loads(json.dumps(meta)))
    ours, theirs = (recognize_by_tensor(r, clips.samples[:5]) for r in (record, again))
    assert ours == theirs
    with pytest.raises(ValueError, match="version"):
        TensorRecognizer.from_arrays(arrays, meta | {"version": 0})


@pytest.mark.parametrize("labels", [["a", "a"], ["a", "b"], ["a", "b", "c", "c"]])
def test_small_libraries_and_motionless_clips_give_finite_answers(labels: list[str]) -> None:
    still = np.zeros((len(labels), 4 * 39 + 2))
    record = fit_tensor_recognizer(still, labels, labels)
    for probe in (still[:1], still[:1] + 1e3):
        (found,) = recognize_by_tensor(record, probe)
        assert np.isfinite([found.person.score, found.task.score]).all()


def test_clips_without_labels_are_refused() -> None:
    with pytest.raises(NotEnoughLabels):
        fit_tensor_recognizer(np.zeros((2, 4 * 39 + 2)), ["a", None], [None, "x"])
