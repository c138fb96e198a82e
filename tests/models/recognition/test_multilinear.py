from __future__ import annotations

import json

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.recognition.multilinear import Multilinear, fit_multilinear, recognize_multilinear
from tests.models.factor_clips import FactorClips, factor_clips


@pytest.fixture(scope="module")
def clips() -> FactorClips:
    return factor_clips()


@pytest.fixture(scope="module")
def record(clips: FactorClips) -> Multilinear:
    return fit_multilinear(*clips.where(clips.takes > 0))


def test_cell_means_map_onto_the_signatures_and_action_parameters(clips: FactorClips) -> None:
    record = fit_multilinear(*clips.where(clips.takes == 0))
    people, actions, _ = record.svd.factors
    index = clips.persons.index("p2") + clips.tasks[: 6 * 4].index("t3")
    assert (clips.persons[index], clips.tasks[index], clips.takes[index]) == ("p2", "t3", 0)
    sample = clips.samples[index]
    np.testing.assert_allclose(record.signature(sample, "t3"), people[2], atol=1e-6)
    np.testing.assert_allclose(record.action(sample, "p2"), actions[3], atol=1e-6)


@pytest.mark.parametrize("known", ["person", "task", "neither"])
def test_held_out_takes_are_recognized(clips: FactorClips, record: Multilinear, known: str) -> None:
    for sample, who, what in zip(*clips.where(clips.takes == 0), strict=True):
        found = recognize_multilinear(
            record,
            sample,
            known_person=who if known == "person" else None,
            known_task=what if known == "task" else None,
        )
        assert (found.person.candidates[0].label, found.task.candidates[0].label) == (who, what)
        for answer in (found.person, found.task):
            assert sum(candidate.score for candidate in answer.candidates) <= 1 + 1e-9


def test_missing_cells_are_completed(clips: FactorClips) -> None:
    missing = np.array([p == "p1" and t == "t2" for p, t in clips.labels])
    record = fit_multilinear(*clips.where(~missing))
    found = recognize_multilinear(record, clips.samples[missing][0], known_task="t2")
    assert found.person.candidates[0].label == "p1"


def test_a_motion_of_no_cell_is_unknown(clips: FactorClips, record: Multilinear) -> None:
    far = recognize_multilinear(record, clips.samples[0] + 5.0)
    assert far.person.label is None
    assert far.task.label is None
    assert far.task.candidates


def test_ranks_can_be_reduced(clips: FactorClips) -> None:
    record = fit_multilinear(clips.samples, clips.persons, clips.tasks, ranks=(3, 4))
    assert record.svd.core.shape[:2] == (3, 4)
    assert recognize_multilinear(record, clips.samples[0]).task.candidates[0].label == "t0"


def test_a_record_comes_back_from_its_arrays(clips: FactorClips, record: Multilinear) -> None:
    arrays, meta = record.to_arrays()
    again = Multilinear.from_arrays(arrays, json.loads(json.dumps(meta)))
    sample = clips.samples[5]
    assert recognize_multilinear(again, sample) == recognize_multilinear(record, sample)
    with pytest.raises(ValueError, match="version"):
        Multilinear.from_arrays(arrays, meta | {"version": 0})


def test_one_person_or_no_pairs_are_refused() -> None:
    with pytest.raises(NotEnoughLabels):
        fit_multilinear(np.eye(3), ["a", "a", "a"], ["x", "y", "z"])
    with pytest.raises(NotEnoughLabels):
        fit_multilinear(np.eye(3), ["a", None, "b"], [None, "y", None])
