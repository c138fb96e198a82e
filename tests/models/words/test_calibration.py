"""Scores are probabilities: of held-out clips with score p, the part p carries the word."""

from __future__ import annotations

import numpy as np
import pytest

from app.models.words.calibration import (
    IDENTITY_CALIBRATION,
    Curve,
    Familiarity,
    WordCalibration,
    calibrate,
)
from app.models.words.model import fit_word_model
from app.numerics.arrays import FloatArray

WORDS = 8


def clips(count: int, seed: int) -> tuple[FloatArray, FloatArray]:
    """Statistics and labels that follow from them only by chance; words 0 and 1 go together."""
    rng = np.random.default_rng(seed)
    statistics = rng.normal(size=(count, 4))
    chances = 1.0 / (1.0 + np.exp(-3.0 * statistics @ rng.normal(size=(4, WORDS)) / 2.0))
    labels = (rng.random(size=chances.shape) < chances).astype(np.float64)
    labels[:, 1] = labels[:, 0]
    return statistics, labels


@pytest.fixture(scope="module")
def both() -> tuple[FloatArray, FloatArray]:
    return clips(900, 1)


def test_scores_of_new_clips_are_the_shares_that_carry_a_word(
    both: tuple[FloatArray, FloatArray],
) -> None:
    statistics, labels = both
    taught = statistics[:500], labels[:500]
    model = fit_word_model(*taught)
    made = calibrate(model, *taught, [str(row) for row in range(500)])
    new = statistics[500:]
    found = made.probabilities(model.outputs(new), model.nearest(new)).ravel()
    truth = labels[500:].ravel()
    for low in np.arange(0.0, 1.0, 0.25):
        within = (found >= low) & (found < low + 0.25)
        assert truth[within].mean() == pytest.approx(found[within].mean(), abs=0.06)


def test_words_that_occur_together_are_more_likely_together() -> None:
    rng = np.random.default_rng(0)
    statistics = rng.normal(size=(300, 3))
    one = (rng.random(300) < 0.5).astype(np.float64)
    names = [str(row) for row in range(300)]

    def dependence(labels: FloatArray) -> float:
        model = fit_word_model(statistics, labels)
        return calibrate(model, statistics, labels, names).dependence

    same, apart = np.stack([one, one], axis=1), (rng.random((300, 2)) < 0.5).astype(np.float64)
    assert dependence(same) < 0.2
    assert dependence(apart) > 0.8


def test_probabilities_rise_with_outputs_and_are_never_0_or_1() -> None:
    low, high = Curve(np.array([0.1, 0.4]), np.array([0.0, 1.0])), Curve(np.zeros(1), np.zeros(1))
    made = WordCalibration(low, high, Familiarity(0.0, 2.0), 0.5)
    outputs = np.linspace(-1.0, 2.0, 301)[None]
    for distance in (0.0, 0.5, 1.0, 50.0):
        found = made.probabilities(outputs, np.array([distance]))[0]
        assert (np.diff(found) > 0).all()
        assert 0 < found[0] < found[-1] < 1


def test_outputs_mean_less_for_a_clip_of_a_stranger() -> None:
    """Each person has a habit of their own, which tells the word among their own clips only."""
    rng = np.random.default_rng(5)
    persons = np.repeat(np.arange(60), 8)
    labels = (rng.random((480, 1)) < 0.5).astype(np.float64)
    habits = rng.normal(size=(60, 6)) * 6.0
    flips = rng.choice([-1.0, 1.0], size=(60, 1))
    told = (labels - 0.5) * flips[persons] * 3.0
    inputs = np.hstack([habits[persons], told]) + rng.normal(size=(480, 7)) * 0.1
    taught, strange = persons < 30, persons >= 30
    model = fit_word_model(inputs[taught], labels[taught])
    recordings = [str(row) for row in range(240)]
    who = [str(person) for person in persons[taught]]
    made = calibrate(model, inputs[taught], labels[taught], recordings, who)
    nearest = model.nearest(inputs[strange])
    assert made.familiarity.of(nearest).mean() < 0.3
    assert made.familiarity.of(np.zeros(1))[0] > 0.9
    # among clips of strangers, no output is as telling as the best ones among those of friends
    assert made.new.outputs.max() < 0.7 < made.known.outputs.max()
    for nobody in (None, ["one"] * 240):
        alone = calibrate(model, inputs[taught], labels[taught], recordings, nobody)
        assert alone.new is alone.known


def test_a_detector_counts_for_a_clip_that_is_far_from_all_others() -> None:
    half = Curve(np.zeros(1), np.full(1, 0.5))
    made = WordCalibration(half, half, Familiarity(0.0, 4.0), 1.0)
    evidence = np.array([[0.9, np.nan], [0.9, np.nan]])
    found = made.probabilities(np.zeros((2, 2)), np.array([1e-3, 1e3]), evidence)
    np.testing.assert_allclose(found[:, 1], found[0, 1])
    assert found[0, 0] == pytest.approx(0.5, abs=0.01)
    assert found[1, 0] == pytest.approx(0.7, abs=0.01)


def test_copies_of_a_recording_are_held_out_together() -> None:
    rng = np.random.default_rng(3)
    statistics, labels = rng.normal(size=(60, 3)), np.eye(6)[rng.integers(6, size=60)]
    twice, labels_twice = np.tile(statistics, (2, 1)), np.tile(labels, (2, 1))
    model = fit_word_model(twice, labels_twice)
    recordings = [str(row) for row in range(60)]
    honest = calibrate(model, twice, labels_twice, recordings * 2)
    fooled = calibrate(model, twice, labels_twice, [str(row) for row in range(120)])
    assert honest.known.probabilities(np.array(0.9)) < fooled.known.probabilities(np.array(0.9))


def test_one_recording_leaves_outputs_as_they_are() -> None:
    statistics, labels = clips(6, 0)
    model = fit_word_model(statistics, labels)
    assert calibrate(model, statistics, labels, ["one"] * 6) is IDENTITY_CALIBRATION


def test_a_query_of_one_word_has_that_words_probability() -> None:
    chances = np.array([[0.2], [0.7]])
    np.testing.assert_allclose(np.exp(-IDENTITY_CALIBRATION.joint_surprise(chances)), chances[:, 0])
    independent = IDENTITY_CALIBRATION.joint_surprise(np.array([[0.5, 0.4]]))
    np.testing.assert_allclose(np.exp(-independent), 0.2)
