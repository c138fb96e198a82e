from __future__ import annotations

import numpy as np
import pytest

from app.errors import ModelNotFitted, NotEnoughLabels
from app.models.correlated_space import CorrelatedSpace, fit_correlated_space

KIND = np.tile(np.arange(3), 20)


@pytest.fixture
def points() -> np.ndarray:
    rng = np.random.default_rng(0)
    places = rng.normal(size=(3, 10)) * 3
    return places[KIND] + rng.normal(size=(60, 10)) * 0.3


@pytest.fixture
def labels() -> np.ndarray:
    # walk, run, jog (half of the runs), fast (run or jump), jump
    odd = np.arange(60) % 2
    return np.stack(
        [KIND == 0, (KIND == 1) & (odd == 0), (KIND == 1) & (odd == 1), KIND > 0, KIND == 2], axis=1
    ).astype(float)


def test_words_find_their_motions_both_ways_of_measuring(
    points: np.ndarray, labels: np.ndarray
) -> None:
    space = fit_correlated_space(points, labels)
    jump = np.eye(5)[4]
    for scores in (space.clip_cosines(points, jump), -space.clip_distances(points, jump)):
        assert set(KIND[np.argsort(-scores)[:20]]) == {2}


def test_a_word_finds_like_motions_that_do_not_carry_it(
    points: np.ndarray, labels: np.ndarray
) -> None:
    scores = fit_correlated_space(points, labels).clip_cosines(points, np.eye(5)[2])
    assert set(KIND[np.argsort(-scores)[:20]]) == {1}


def test_motions_find_their_words(points: np.ndarray, labels: np.ndarray) -> None:
    space = fit_correlated_space(points, labels)
    for scores in (space.word_cosines(points), -space.word_distances(points)):
        best = scores.argmax(axis=1)
        assert (labels[np.arange(60), best] > 0).mean() > 0.6
        assert (best[KIND == 0] == 0).all()


def test_survives_being_taken_apart(points: np.ndarray, labels: np.ndarray) -> None:
    space = fit_correlated_space(points, labels)
    arrays, meta = space.to_arrays()
    again = CorrelatedSpace.from_arrays(arrays, meta)
    np.testing.assert_array_equal(again.word_cosines(points), space.word_cosines(points))
    with pytest.raises(ModelNotFitted):
        CorrelatedSpace.from_arrays(arrays, {"version": 0})


def test_too_few_labels_are_refused_and_few_are_enough(
    points: np.ndarray, labels: np.ndarray
) -> None:
    with pytest.raises(NotEnoughLabels):
        fit_correlated_space(points[:2], labels[:2])
    with pytest.raises(NotEnoughLabels):
        fit_correlated_space(points, labels[:, :0])
    space = fit_correlated_space(points[:3], labels[:3])
    assert np.isfinite(space.word_cosines(points)).all()


def test_labels_or_points_that_are_all_the_same_do_no_harm(
    points: np.ndarray, labels: np.ndarray
) -> None:
    same = fit_correlated_space(points, np.ones_like(labels))
    assert np.isfinite(same.clip_cosines(points, labels[0])).all()
    still = fit_correlated_space(np.zeros_like(points), labels)
    assert np.isfinite(still.word_distances(points)).all()
