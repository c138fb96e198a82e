"""Scores of mode cca are probabilities: of held-out clips with score p, the part p is so."""

from __future__ import annotations

import json

import numpy as np
import pytest

from app.models.words.correlated_space import fit_correlated_space
from app.models.words.cosine_calibration import START, CosineCalibration, calibrate_cosines
from app.numerics.arrays import FloatArray

WORDS = 6


def clips(count: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Points and labels that follow from them only by chance; some words are rare."""
    rng = np.random.default_rng(seed)
    points = rng.normal(size=(count, 4))
    directions = np.random.default_rng(0).normal(size=(4, WORDS))
    odds = 1.5 * points @ directions - np.array([0.0, 0.0, 1.0, 2.0, 3.0, 4.0])
    labels = rng.random(odds.shape) < 1.0 / (1.0 + np.exp(-odds))
    return points, labels.astype(np.float64)


def groups(count: int) -> list[str]:
    return [str(row) for row in range(count)]


def test_scores_of_new_clips_are_the_shares_that_carry_a_word() -> None:
    points, labels = clips(1500, 1)
    taught = points[:700], labels[:700]
    space, made = fit_correlated_space(*taught), calibrate_cosines(*taught, groups(700)).curve
    found = made.of_words(space.single_word_cosines(points[700:]))
    truth = labels[700:]
    for low in (0.0, 0.25, 0.5):
        within = (found >= low) & (found < low + 0.25)
        assert within.sum() > 100
        assert truth[within].mean() == pytest.approx(found[within].mean(), abs=0.08)
    np.testing.assert_allclose(found.mean(axis=0), truth.mean(axis=0), atol=0.08)


def test_at_the_same_angle_the_more_frequent_word_is_more_likely() -> None:
    points, labels = clips(400, 2)
    made = calibrate_cosines(points, labels, groups(400)).curve
    common, rare = made.of_words(np.full((1, WORDS), 0.5))[0, [0, WORDS - 1]]
    assert common > rare + 0.1


def test_scores_rise_strictly_and_are_never_certain() -> None:
    made = CosineCalibration(np.array([0.01]), 0.0, 0.5, 1.0)
    found = made.probabilities(np.linspace(-1.0, 1.0, 2001), 1e-300)
    assert (np.diff(found) > 0).all()
    assert 0.0 < found[0] < found[-1] < 1.0


@pytest.mark.parametrize("count", [3, 4])
def test_with_too_few_clips_to_hold_out_there_is_still_a_curve(count: int) -> None:
    points, labels = clips(count, 3)
    made = calibrate_cosines(points, labels, ["one"] * (count - 1) + ["other"]).curve
    assert (made.level, made.slope, made.weight) == START
    assert ((made.shares > 0.0) & (made.shares < 1.0)).all()


def test_words_of_all_or_no_clips_give_finite_scores() -> None:
    points, _ = clips(60, 4)
    labels = np.tile([1.0, 0.0], (60, 1))
    made = calibrate_cosines(points, labels, groups(60)).curve
    found = made.of_words(np.zeros((1, 2)))[0]
    assert np.isfinite(found).all()
    assert found[0] > 0.8 > 0.2 > found[1]


def test_a_record_is_stored_and_read_back() -> None:
    made = calibrate_cosines(*clips(80, 5), groups(80)).curve
    arrays, meta = made.to_arrays()
    again = CosineCalibration.from_arrays(arrays, json.loads(json.dumps(meta)))
    cosines = np.linspace(-1.0, 1.0, WORDS)[None]
    np.testing.assert_array_equal(again.of_words(cosines), made.of_words(cosines))
