from __future__ import annotations

import numpy as np
import pytest

from app.errors import NotEnoughLabels
from app.models.words.correlated_space import RIDGE, CorrelatedSpace, fit_correlated_space

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


def test_words_find_their_motions_by_angle_and_by_distance(
    points: np.ndarray, labels: np.ndarray
) -> None:
    space = fit_correlated_space(points, labels)
    jump = np.eye(5)[4]
    for scores in (space.clip_cosines(points, jump), -space.clip_distances(points, jump)):
        assert set(KIND[np.argsort(-scores)[:20]]) == {2}


def test_a_word_finds_similar_motions_without_the_word(
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


def test_a_record_comes_back_from_its_arrays(points: np.ndarray, labels: np.ndarray) -> None:
    space = fit_correlated_space(points, labels)
    arrays, meta = space.to_arrays()
    again = CorrelatedSpace.from_arrays(arrays, meta)
    np.testing.assert_array_equal(again.word_cosines(points), space.word_cosines(points))
    with pytest.raises(ValueError, match="version"):
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


def test_equal_labels_or_points_give_finite_results(points: np.ndarray, labels: np.ndarray) -> None:
    same = fit_correlated_space(points, np.ones_like(labels))
    assert np.isfinite(same.clip_cosines(points, labels[0])).all()
    still = fit_correlated_space(np.zeros_like(points), labels)
    assert np.isfinite(still.word_distances(points)).all()


def test_the_pseudo_inverse_solves_the_printed_equations(
    points: np.ndarray, labels: np.ndarray
) -> None:
    """Eqs 11-14 and 16 with label vectors that are rank deficient (fast = run, jog or jump)."""
    space = fit_correlated_space(points, labels, ridge=0.0)
    pair = space.pair
    x, y = points - points.mean(axis=0), labels - labels.mean(axis=0)
    assert np.linalg.matrix_rank(y) < labels.shape[1]
    s_x, s_y, s_xy = (left.T @ right / 59 for left, right in ((x, x), (y, y), (x, y)))
    unit = np.eye(pair.a.shape[1])
    np.testing.assert_allclose(pair.a.T @ s_x @ pair.a, unit, atol=1e-8)
    np.testing.assert_allclose(pair.b.T @ s_y @ pair.b, unit, atol=1e-8)
    left = s_xy @ np.linalg.pinv(s_y) @ s_xy.T @ pair.a
    np.testing.assert_allclose(left, s_x @ pair.a * pair.correlations**2, atol=1e-8)
    right = s_xy.T @ np.linalg.solve(s_x, s_xy) @ pair.b
    np.testing.assert_allclose(right, s_y @ pair.b * pair.correlations**2, atol=1e-8)
    s_fg = (x @ pair.a).T @ (y @ pair.b) / 59
    np.testing.assert_allclose(space.words_to_motions, s_fg.T, atol=1e-8)
    np.testing.assert_allclose(space.motions_to_words, s_fg, atol=1e-8)
    np.testing.assert_allclose(s_fg, np.diag(pair.correlations), atol=1e-8)


def test_c_and_d_are_least_squares_under_the_ridge(points: np.ndarray, labels: np.ndarray) -> None:
    """Eq. 15: no other transform near it has a smaller penalized error."""
    space = fit_correlated_space(points, labels)
    f, g = space.motions(points), space.words(labels)
    for inputs, outputs, found in (
        (g, f, space.words_to_motions),
        (f, g, space.motions_to_words),
    ):
        penalty = RIDGE * np.trace(inputs.T @ inputs) / inputs.shape[1]
        gradient = inputs.T @ (inputs @ found - outputs) + penalty * found
        np.testing.assert_allclose(gradient, 0.0, atol=1e-7)
