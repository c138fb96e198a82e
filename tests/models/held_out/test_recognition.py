from __future__ import annotations

import numpy as np
import pytest

from app.models.held_out.recognition import (
    Clips,
    held_out_recognition,
    signature_figures,
    unknown_figures,
)
from app.models.recognition.perera import fit_tensor_recognizer
from app.models.recognition.recognizer import fit_recognizer
from tests.models.factor_clips import POSES, factor_clips


def test_models_are_compared_with_the_prior() -> None:
    clips = factor_clips(persons=4, tasks=5, takes=3, width=POSES)
    groups = [str(i) for i in range(len(clips.persons))]
    figures = held_out_recognition(clips.samples, clips.persons, clips.tasks, groups).figures
    assert set(figures) == {"default", "multilinear", "perera", "pca", "prior"}
    for method in ("default", "multilinear", "perera", "pca"):
        assert figures[method]["both"] > 0.9
        assert figures[method]["clips"] == 60
    assert figures["prior"]["person"] <= 0.25
    assert figures["prior"]["task"] <= 0.2


def test_signatures_are_judged_on_joint_angles() -> None:
    clips = factor_clips(persons=4, tasks=5, takes=3, width=POSES)
    groups = [str(i) for i in range(len(clips.persons))]
    figures = signature_figures(clips.samples, clips.persons, clips.tasks, groups)
    assert set(figures) == {"signatures", "pca", "prior"}
    assert figures["signatures"]["both"] > 0.9


def test_a_recording_is_never_on_both_sides() -> None:
    clips = factor_clips(persons=4, tasks=5, takes=3, width=POSES)
    cells = [f"{p} {t}" for p, t in zip(clips.persons, clips.tasks, strict=True)]
    apart = held_out_recognition(
        clips.samples, clips.tasks, cells, cells
    ).figures  # the cell's own name can never be guessed when all its takes are held out
    assert apart["default"]["task"] == 0.0


def test_a_library_without_persons_has_task_figures_only() -> None:
    clips = factor_clips(persons=3, tasks=4, takes=3, width=POSES)
    none: list[str | None] = [None] * len(clips.tasks)
    groups = [str(i) for i in range(len(clips.tasks))]
    figures = held_out_recognition(clips.samples, none, clips.tasks, groups).figures
    assert "multilinear" not in figures
    assert figures["default"]["task"] > 0.9
    assert "person" not in figures["default"]


def test_error_rates_for_unknown_labels_are_reported() -> None:
    clips = factor_clips()
    figures = unknown_figures(fit_recognizer(clips.samples, clips.persons, clips.tasks))
    assert set(figures) == {"person", "task"}
    for shares in figures.values():
        errors = shares["false_acceptance"] + shares["false_rejection"]
        assert shares["balanced_accuracy"] == pytest.approx(1 - errors / 2)
        assert shares["balanced_accuracy"] > 0.75


def test_a_library_with_one_label_says_that_nothing_could_be_held_out() -> None:
    clips = factor_clips(persons=4, tasks=1, takes=5, width=POSES)
    for fit in (fit_recognizer, fit_tensor_recognizer):
        figures = unknown_figures(fit(clips.samples, clips.persons, clips.tasks))
        assert figures["task"] == {
            "reason": "No task could be held out: the clips have 1 task, and 3 are needed."
        }
        assert "area_under_curve" in figures["person"]


def test_copies_stay_with_their_clips() -> None:
    clips = factor_clips(persons=2, tasks=2, takes=2)
    copies = [row[None] if i % 2 else None for i, row in enumerate(clips.samples)]
    whole = Clips(clips.samples, clips.persons, clips.tasks, clips.persons, copies)
    part = whole.part(np.array([5, 2, 7]))
    assert part.copies is not None
    assert part.copies[1] is None
    for row, own in ((0, part.copies[0]), (2, part.copies[2])):
        np.testing.assert_array_equal(own, part.samples[[row]])
