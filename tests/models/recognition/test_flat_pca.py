from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.recognition.flat_pca import fit_flat_pca, recognize_flat
from tests.models.factor_clips import factor_clips


@pytest.mark.parametrize("known", ["person", "task", "neither"])
def test_held_out_takes_are_recognized(known: str) -> None:
    clips = factor_clips()
    record = fit_flat_pca(*clips.where(clips.takes > 0))
    for sample, who, what in zip(*clips.where(clips.takes == 0), strict=True):
        found = recognize_flat(
            record,
            sample,
            known_person=who if known == "person" else None,
            known_task=what if known == "task" else None,
        )
        assert (found.person.candidates[0].label, found.task.candidates[0].label) == (who, what)


def test_a_person_is_a_vector_for_each_task() -> None:
    clips = factor_clips(persons=5, tasks=6)
    record = fit_flat_pca(clips.samples, clips.persons, clips.tasks, dimensions=10)
    assert record.coefficients.shape == (30, 10)


def test_a_person_is_not_recognized_at_a_task_that_they_never_did() -> None:
    """The difference to the multilinear model: nothing is completed."""
    clips = factor_clips()
    missing = np.array([p == "p1" and t == "t2" for p, t in clips.labels])
    record = fit_flat_pca(*clips.where(~missing))
    found = recognize_flat(record, clips.samples[missing][0], known_task="t2")
    scores = {candidate.label: candidate.score for candidate in found.person.candidates}
    assert scores["p1"] == 0.0


def test_clips_without_labels_are_refused() -> None:
    with pytest.raises(NotEnoughLabels):
        fit_flat_pca(np.eye(2), ["a", None], [None, "x"])
