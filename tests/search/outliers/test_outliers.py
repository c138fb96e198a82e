"""Outliers within labels: planted ones are found, and others are not."""

from __future__ import annotations

import numpy as np

from app.search.outliers.outliers import OutlierReason, far_ones, swapped_ones


def test_a_clip_with_a_wrong_label_is_far_and_its_right_label_is_suggested() -> None:
    rng = np.random.default_rng(0)
    codes = np.repeat([0, 1, 2], 40)
    vectors = 8.0 * np.eye(16)[codes] + rng.normal(size=(120, 16))
    codes[5] = 2
    codes[119] = -1
    found = far_ones(vectors, codes)
    assert [(one.number, one.suggested) for one in found] == [(5, 0)]
    assert found[0].reason is OutlierReason.FAR
    assert found[0].value > 2 * found[0].usual


def test_a_strange_clip_is_far_without_a_suggestion() -> None:
    rng = np.random.default_rng(1)
    codes = np.repeat([0, 1], 30)
    vectors = 5.0 * np.eye(16)[codes] + rng.normal(size=(60, 16))
    vectors[7, 9] += 60
    vectors[codes == 1] -= 100
    assert [(one.number, one.suggested) for one in far_ones(vectors, codes)] == [(7, None)]


def test_few_clips_do_not_say_what_is_usual() -> None:
    vectors = np.random.default_rng(2).normal(size=(5, 4))
    vectors[0] += 100
    assert far_ones(vectors, np.zeros(5, dtype=np.int64)) == []


def test_the_clip_that_moves_the_other_side_is_swapped() -> None:
    dominance = np.array([0.8, 0.7, 0.9, 0.6, 0.75, -0.8, np.nan, 0.65, *(0.1, -0.9, 0.9) * 3])
    codes = np.array([0] * 8 + [1] * 9)
    (found,) = swapped_ones(dominance, codes)
    assert (found.number, found.reason) == (5, OutlierReason.SWAPPED)
    assert (found.value, found.usual) == (-0.8, 0.7)
