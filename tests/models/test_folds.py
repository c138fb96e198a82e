from __future__ import annotations

import numpy as np

from app.models.folds import grouped_folds, recording_of


def test_a_recording_in_two_formats_is_one() -> None:
    assert recording_of("cmu-bvh/02_01.bvh") == recording_of("cmu-asfamc/02_01.AMC") == "02_01"


def test_groups_stay_together_and_folds_are_even() -> None:
    groups = [f"r{index % 37}" for index in range(100)]
    folds = grouped_folds(groups, 5)
    assert all(len({f for f, g in zip(folds, groups, strict=True) if g == x}) == 1 for x in groups)
    assert np.ptp(np.bincount(folds)) <= 3


def test_the_order_of_clips_does_not_matter() -> None:
    groups = [f"r{index}" for index in range(20)]
    np.testing.assert_array_equal(grouped_folds(groups[::-1], 4)[::-1], grouped_folds(groups, 4))
    assert (grouped_folds(groups, 4) != grouped_folds(groups, 4, seed=1)).any()
