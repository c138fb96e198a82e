"""True positives, confusions and precision of rankings by class."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.models.held_out.class_rankings import confusion_matrix, judge_ranking, true_positive_rates


def test_a_ranking_is_judged_among_its_nearest() -> None:
    # class 3 is of no query: it stands in the way, but is no column of the confusion
    found = np.array([0, 3, 1, 0, 0, 1, 2])
    judged = judge_ranking(found, own=0, classes=3, k=20)
    assert judged.precision.tolist() == pytest.approx([1.0, 0.5, 3 / 7])
    assert judged.average_precision == pytest.approx((1 + 2 / 4 + 3 / 5) / 3)
    assert judged.true_positives == pytest.approx(1 / 3)  # of 0 3 1
    assert judged.retrieved.tolist() == pytest.approx([2 / 3, 1 / 3, 0])  # of 0 1 0
    assert judge_ranking(found, own=0, classes=3, k=1).true_positives == 1.0


def test_rates_and_confusion_are_means_over_the_queries_of_a_class() -> None:
    judged = [
        judge_ranking(np.array([0, 1, 1]), 0, 3, k=2),
        judge_ranking(np.array([1, 0, 1]), 0, 3, k=2),
        judge_ranking(np.array([1, 0, 0]), 1, 3, k=2),
    ]
    np.testing.assert_allclose(true_positive_rates(judged, 3), [0.5, 1.0, 0.0])
    np.testing.assert_allclose(
        confusion_matrix(judged, 3), [[0.5, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 0.0]]
    )


@given(seed=st.integers(0, 10_000), k=st.integers(1, 30))
@settings(max_examples=50, deadline=None)
def test_a_perfect_ranking_is_perfect_and_rows_sum_to_one(seed: int, k: int) -> None:
    rng = np.random.default_rng(seed)
    found = np.append(rng.integers(0, 5, size=20), 2)
    judged = judge_ranking(found, 2, 4, k)
    assert judged.retrieved.sum() == pytest.approx(1.0)
    perfect = judge_ranking(found[np.argsort(found != 2, kind="stable")], 2, 4, k)
    assert (perfect.true_positives, perfect.average_precision) == (1.0, 1.0)
    assert perfect.retrieved[2] == perfect.precision[0] == 1.0
    assert judged.true_positives <= perfect.true_positives


def test_a_query_without_relevant_items_is_refused() -> None:
    with pytest.raises(ValueError, match="without relevant items"):
        judge_ranking(np.array([1, 2]), own=0, classes=3, k=20)
