"""Shares, confusions and errors for new labels, of constructed trials."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.evaluate.recognition.clips import NO_TREE
from app.evaluate.recognition.methods import NO_GUESS, Guess
from app.evaluate.recognition.shares import (
    Share,
    chance,
    confusion,
    recognized,
    task_in_tree,
    unknown,
)
from app.evaluate.recognition.trials import FactorResult, Trial
from app.models.words.language.label_tree import label_tree

NOBODY = FactorResult(None, True, NO_GUESS, 0)


def result(
    truth: str | None, guess: str, novelty: float = -1.0, *, new: bool = False
) -> FactorResult:
    return FactorResult(truth, new, Guess(guess, novelty <= 0, novelty), 4)


def trial(
    task: FactorResult, person: FactorResult = NOBODY, left_out: tuple[str, ...] = ()
) -> Trial:
    return Trial(0, left_out, person, task, together=task.guess.novelty < -2)


def test_shares_count_clips_whose_label_was_seen() -> None:
    trials = [
        trial(result("walk", "walk"), result("ada", "bruno")),
        trial(result("run", "walk"), result("ada", "ada")),
        trial(result("run", "run", 2.0), result("ada", "ada")),  # refused, but the best candidate
        trial(result("hop", "run", new=True), result("ada", "ada")),
        trial(result(None, "walk"), result("ada", "ada")),
    ]
    found = recognized(trials)
    assert (found.task, found.person, found.both) == (Share(2, 3), Share(4, 5), Share(1, 3))
    assert chance(trials) == (0.25, 0.25, 0.0625)


def test_an_error_within_a_branch_weighs_less() -> None:
    """By hand: jog is move/run/jog, run is move/run, stand is alone."""
    trials = [
        trial(result("jog", "jog")),
        trial(result("jog", "run")),
        trial(result("jog", "stand")),
        trial(result("hop", "run", new=True)),
        trial(result(None, "walk")),
    ]
    tree = label_tree(["jog", "run", "stand"], {})
    assert task_in_tree(trials, tree) == pytest.approx((1 + 4 / 5 + 0) / 3)
    assert task_in_tree(trials, NO_TREE) == pytest.approx(recognized(trials).task.value)
    assert task_in_tree([], tree) is None


def test_without_judged_trials_there_is_no_share() -> None:
    found = recognized([trial(result(None, "walk"))])
    assert found.task.value is None
    assert found.task.interval == (0.0, 1.0)
    assert chance([]) == (None, None, None)
    assert unknown([trial(result("walk", "walk"))], "task") is None
    names, shares = confusion([], "task")
    assert names == ()
    assert shares.shape == (0, 0)


def test_rows_of_the_confusion_are_true_labels() -> None:
    trials = [
        trial(result(truth, guess)) for truth, guess in ("ab", "ab", "ab", "aa", "bb", "bb", "ca")
    ]
    names, shares = confusion(trials, "task")
    assert names == ("a", "b", "c")
    assert shares.tolist() == [[0.25, 0.75, 0], [0, 1, 0], [1, 0, 0]]


def test_errors_for_new_labels() -> None:
    trials = [
        trial(result("hop", "run", 3.0, new=True), left_out=("hop",)),
        trial(result("hop", "run", -1.0, new=True), left_out=("hop",)),
        trial(result("walk", "walk", -2.0), left_out=("hop",)),
        trial(result("walk", "run", 1.0), left_out=("hop",)),
        trial(result("sit", "run", 2.0, new=True), left_out=("sit",)),
        trial(result("walk", "walk", -3.0), left_out=("sit",)),
    ]
    found = unknown(trials, "task")
    assert found is not None
    assert (found.refused, found.accepted) == (Share(2, 3), Share(2, 3))
    assert found.accepted_together == Share(1, 1)
    assert (found.false_acceptance, found.false_rejection) == pytest.approx((1 / 3, 1 / 3))
    assert found.balanced_accuracy == pytest.approx(2 / 3)
    # of nine pairs, only (-1 new, 1 known) is the wrong way round
    assert found.area_under_curve == pytest.approx(8 / 9)
    assert found.equal_error_rate == pytest.approx(1 / 3)
    hop, sit = found.categories
    assert (hop.label, hop.refused, hop.accepted, hop.taken_for) == (
        "hop", Share(1, 2), Share(1, 2), "run",
    )  # fmt: skip
    assert (sit.balanced_accuracy, sit.taken_for) == (1.0, None)
    assert found.worst is hop


_NOVELTIES = st.lists(st.integers(-5, 5).map(float), min_size=1, max_size=12)


@given(known=_NOVELTIES, new=_NOVELTIES)
def test_the_curve_agrees_with_counting(known: list[float], new: list[float]) -> None:
    trials = [trial(result("a", "a", n)) for n in known]
    trials += [trial(result("b", "a", n, new=True), left_out=("b",)) for n in new]
    found = unknown(trials, "task")
    assert found is not None
    thresholds = [-np.inf, *sorted(set(known + new))]
    counted = [
        (np.mean([n <= t for n in new]), np.mean([k > t for k in known])) for t in thresholds
    ]
    np.testing.assert_allclose(found.curve, counted)
    pairs = [(n > k) + 0.5 * (n == k) for n in new for k in known]
    assert found.area_under_curve == pytest.approx(np.mean(pairs))
    assert 0 <= found.equal_error_rate <= 1
