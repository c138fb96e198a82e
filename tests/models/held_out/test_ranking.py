from __future__ import annotations

import numpy as np
import pytest

from app.models.held_out.ranking import (
    average_precision,
    brier_score,
    calibration_error,
    f_where_recall_is_precision,
    mean_average_precision,
    precision_at_recalls,
    top_k_rate,
)

SCORES = np.array([0.9, 0.1, 0.8, 0.5])
RELEVANT = np.array([True, False, False, True])


def test_average_precision_is_equation_20() -> None:
    assert average_precision(SCORES, RELEVANT) == pytest.approx((1 / 1 + 2 / 3) / 2)
    assert average_precision(SCORES, ~RELEVANT) == pytest.approx((1 / 2 + 2 / 4) / 2)
    assert average_precision(SCORES, np.zeros(4, dtype=bool)) == 0.0


def test_means_leave_out_queries_without_an_answer() -> None:
    scores = np.stack([SCORES, SCORES, SCORES])
    relevant = np.stack([RELEVANT, ~RELEVANT, np.zeros(4, dtype=bool)])
    expected = (average_precision(SCORES, RELEVANT) + average_precision(SCORES, ~RELEVANT)) / 2
    assert mean_average_precision(scores, relevant) == pytest.approx(expected)
    assert mean_average_precision(scores, np.zeros_like(relevant)) == 0.0


def test_f_counts_all_pairs_at_once() -> None:
    scores = np.array([[0.9, 0.8], [0.1, 0.7]])
    relevant = np.array([[True, False], [False, True]])
    assert f_where_recall_is_precision(scores, relevant) == 0.5
    assert f_where_recall_is_precision(scores, relevant & False) == 0.0


def test_top_k_counts_clips_with_any_word_among_the_best() -> None:
    scores = np.array([[0.9, 0.8, 0.1], [0.9, 0.8, 0.1], [0.0, 0.0, 0.0]])
    labels = np.array([[False, True, True], [False, False, True], [False, False, False]])
    assert top_k_rate(scores, labels, 2) == 0.5
    assert top_k_rate(scores, labels, 3) == 1.0


def test_equal_scores_keep_their_order() -> None:
    assert average_precision(np.zeros(3), np.array([True, False, False])) == 1.0
    assert average_precision(np.zeros(3), np.array([False, False, True])) == pytest.approx(1 / 3)


def test_precision_at_a_recall_is_that_of_the_shortest_list_that_reaches_it() -> None:
    scores = np.array([[0.9, 0.8, 0.7], [0.6, 0.5, 0.4]])
    hits = np.array([[True, False, True], [False, False, True]])
    found = precision_at_recalls(scores, hits, np.array([0.0, 1 / 3, 0.5, 1.0]))
    np.testing.assert_allclose(found, [1.0, 1.0, 2 / 3, 0.5])


def test_the_calibration_error_is_the_difference_of_scores_and_shares() -> None:
    chances = np.repeat([0.15, 0.85], 20)
    is_true = np.repeat([True, False, True, False], [3, 17, 17, 3])
    assert calibration_error(chances, is_true) == pytest.approx(0.0, abs=1e-12)
    assert calibration_error(1.0 - chances, is_true) == pytest.approx(0.7)
    assert brier_score(chances, is_true) == pytest.approx(0.15 * 0.85)
