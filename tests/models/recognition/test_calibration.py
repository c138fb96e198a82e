from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.models.recognition.calibration import (
    MAX_FALSE_ACCEPTANCE,
    NEW,
    fit_calibration,
    softmax,
)

NONE = np.zeros((0, 2)), np.zeros(0), np.zeros(0, dtype=int)


def test_the_threshold_separates_known_from_new_clips() -> None:
    novelty = np.array([-9.0, -7.0, 1.0, 3.0])
    found = fit_calibration(np.zeros((4, 2)), novelty, np.array([0, 1, -1, -1]))
    assert -7.0 < found.threshold < 1.0
    assert found.error_rates() == (0.0, 0.0)
    assert found.error_rates(5.0) == (1.0, 0.0)
    assert found.error_rates(-20.0) == (0.0, 1.0)


def test_evidence_that_is_often_wrong_is_believed_less() -> None:
    rng = np.random.default_rng(0)
    evidence = 20 * rng.normal(size=(200, 3))
    right = evidence.argmax(axis=1)
    wrong = np.where(rng.random(200) < 0.4, rng.integers(0, 3, 200), right)
    sure = fit_calibration(evidence, np.zeros(200), right)
    unsure = fit_calibration(evidence, np.zeros(200), wrong)
    assert unsure.temperature > 3 * sure.temperature


def test_beliefs_sum_to_the_belief_in_being_known() -> None:
    found = fit_calibration(np.zeros((4, 2)), np.array([-9.0, -7, 1, 3]), np.array([0, 1, -1, -1]))
    beliefs = found.beliefs(np.array([[2.0, 1.0]] * 3), np.array([-1e9, found.threshold, 1e9]))
    np.testing.assert_allclose(beliefs.sum(axis=1), [1.0, 0.5, 0.0], atol=1e-9)


def test_a_surely_new_clip_still_has_a_best_candidate() -> None:
    evidence = np.array([[-3.0, -1.0, -2.0]])
    for new in (0.0, 1e3, 1e9):
        beliefs = fit_calibration(*NONE).beliefs(evidence, np.array([new]))
        assert np.argsort(-beliefs[0], kind="stable").tolist() == [1, 2, 0]
        assert beliefs.sum() <= 1.0


def test_without_held_out_clips_there_is_a_calibration() -> None:
    found = fit_calibration(*NONE)
    assert (found.temperature, found.threshold, found.scale) == (1.0, 0.0, 1.0)
    assert found.error_rates() == (0.0, 0.0)


def test_softmax_survives_impossible_labels() -> None:
    np.testing.assert_allclose(softmax(np.array([[-np.inf, 0.0, -1e9]])), [[0.0, 1.0, 0.0]])


@given(
    st.lists(st.floats(-50, 50), min_size=1, max_size=40),
    st.lists(st.floats(-50, 50), min_size=1, max_size=40),
    st.floats(0.001, 0.999),
)
def test_no_more_new_ones_are_accepted_than_allowed(
    known: list[float], new: list[float], rate: float
) -> None:
    novelty = np.array([*known, *new])
    truth = np.array([0] * len(known) + [-1] * len(new))
    found = fit_calibration(np.zeros((len(novelty), 1)), novelty, truth)
    accepted, rejected = found.at_false_acceptance(rate).error_rates()
    assert accepted <= rate
    looser = [t for t in new if (np.array(new) <= t).mean() <= rate]
    best = (np.array(known) > max(looser)).mean() if looser else 1.0
    assert rejected <= best


def test_the_curve_falls_and_its_area_measures_the_separation() -> None:
    rng = np.random.default_rng(1)
    novelty = np.concatenate([rng.normal(0, 1, 300), rng.normal(2, 1, 200)])
    truth = np.array([0] * 300 + [-1] * 200)
    found = fit_calibration(np.zeros((500, 1)), novelty, truth)
    thresholds, accepted, rejected = np.array(found.curve()).T
    assert (np.diff(thresholds) > 0).all()
    assert (np.diff(accepted) >= 0).all()
    assert (np.diff(rejected) <= 0).all()
    pairs = (novelty[300:, None] > novelty[None, :300]).mean()
    assert found.area_under_curve() == pytest.approx(pairs)
    assert fit_calibration(*NONE).curve() == []
    assert fit_calibration(*NONE).at_false_acceptance(0.1).threshold == 0.0


def test_known_clips_that_were_not_seen_in_training_do_not_move_the_threshold() -> None:
    rng = np.random.default_rng(2)
    usual, unusual, new = rng.normal(-6, 1, 60), rng.normal(1, 1, 60), rng.normal(6, 2, 60)
    novelty = np.concatenate([usual, unusual, new])
    truth = np.repeat([0, 0, NEW], 60)
    seen = np.repeat([True, False, False], 60)
    evidence = np.zeros((180, 1))
    judged = fit_calibration(evidence, novelty, truth, seen)
    assert -2.6 < judged.threshold < 0.0  # two deviations from both, or in the gap
    assert len(judged.known_novelty) == 60
    assert fit_calibration(evidence, novelty, truth).threshold > 1.0
    few = fit_calibration(evidence[50:], novelty[50:], truth[50:], seen[50:])
    assert few.threshold == fit_calibration(evidence[50:], novelty[50:], truth[50:]).threshold


def test_if_known_and_new_overlap_few_new_ones_are_called_known() -> None:
    rng = np.random.default_rng(6)
    novelty = np.concatenate([rng.normal(-6, 20, 500), rng.normal(0, 10, 500)])
    truth, seen = np.repeat([0, NEW], 500), np.repeat([True, False], 500)
    found = fit_calibration(np.zeros((1000, 1)), novelty, truth, seen)
    assert found.error_rates()[0] == pytest.approx(MAX_FALSE_ACCEPTANCE, abs=0.003)


@pytest.mark.parametrize("far", [50.0, 1000.0, 1e6])
def test_one_task_that_is_far_from_all_others_does_not_hide_the_other_new_ones(far: float) -> None:
    rng = np.random.default_rng(3)
    known, new = rng.normal(-20, 5, 200), rng.normal(10, 5, 170)
    novelty = np.concatenate([known, new, rng.normal(far, far / 4, 30)])
    truth = np.where(np.arange(400) < 200, 0, NEW)
    found = fit_calibration(np.zeros((400, 1)), novelty, truth, truth != NEW)
    accepted, rejected = found.error_rates()
    assert accepted <= 0.02
    assert rejected <= 0.02


def test_without_repeated_takes_simulated_ones_set_the_threshold() -> None:
    rng = np.random.default_rng(4)
    unusual, new = rng.normal(1, 1, 60), rng.normal(6, 2, 60)
    novelty, truth = np.concatenate([unusual, new]), np.repeat([0, NEW], 60)
    seen, simulated = np.zeros(120, dtype=bool), rng.normal(-6, 1, 90)
    evidence = np.zeros((120, 1))
    found = fit_calibration(evidence, novelty, truth, seen, simulated)
    assert found.threshold == pytest.approx(-2.0, abs=0.6)
    np.testing.assert_array_equal(found.known_novelty, np.sort(simulated))
    without = fit_calibration(evidence, novelty, truth, seen)
    assert without.threshold > 1.0
    # nothing new was held out: nothing can be said by simulated takes either
    none_new = fit_calibration(evidence[:60], unusual, truth[:60], seen[:60], simulated)
    assert none_new.threshold == fit_calibration(evidence[:60], unusual, truth[:60]).threshold


def test_a_wide_gap_between_known_and_new_holds_the_threshold() -> None:
    rng = np.random.default_rng(5)
    known, spread = rng.normal(-40, 3, 100), np.abs(rng.normal(0, 60, 100))
    truth, seen = np.repeat([0, NEW], 100), np.repeat([True, False], 100)
    thresholds = []
    for gap in (0.0, 30.0, 100.0):
        novelty = np.concatenate([known, known.max() + gap + spread])
        found = fit_calibration(np.zeros((200, 1)), novelty, truth, seen)
        thresholds.append(found.threshold - known.max())
    assert thresholds[0] < 0
    assert thresholds[0] < thresholds[1] < thresholds[2]
    assert 40 < thresholds[2] < 60
