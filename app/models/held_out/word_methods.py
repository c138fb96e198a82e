"""The word methods that are compared. Each is fitted on some labeled clips and scores others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from app.models.words.calibration import WordCalibration, calibrate
from app.models.words.correlated_space import CorrelatedSpace, fit_correlated_space
from app.models.words.correlated_words import (
    CANDIDATES,
    CCA,
    CorrelatedWords,
    chosen_dimensions,
    dimension_losses,
    fit_correlated_words,
)
from app.models.words.library import default_scores
from app.models.words.model import clip_cosines, fit_word_model
from app.models.words.symbol_space import (
    DIMENSIONS,
    LANDMARKS,
    MAX_WHOLE_LIBRARY,
    possible_dimensions,
)
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.mds import metric_mds, place

PRIOR, DEFAULT, CCA_SCORE, PRINTED = "prior", "default", "cca-score", "printed"


@dataclass(frozen=True, slots=True)
class LabeledClips:
    """N labeled clips.

    landmarks: (C,) ascending rows of the clips that are landmarks of some fold; distances: (N, C)
    of all symbols to theirs; inputs: (N, p) of the word model; words: V; labels: (N, V); groups: N,
    equal for files of one recording; persons: N, equal for clips of one person, or None; fold:
    (N,); likelihoods: (N, N) log likelihood of each motion under each symbol, None without it.
    """

    landmarks: IntArray
    distances: FloatArray
    inputs: FloatArray
    words: tuple[str, ...]
    labels: FloatArray
    groups: tuple[str, ...]
    persons: tuple[str, ...] | None
    fold: IntArray
    likelihoods: FloatArray | None = None


@dataclass(frozen=True, slots=True)
class Scores:
    """The scores of n held-out clips by one method.

    words: (n, V) scores of the words of each clip; clips: a function from label vectors
    (queries, V) to scores of the clips (queries, n).
    """

    words: FloatArray
    clips: Callable[[FloatArray], FloatArray]


def score(
    clips: LabeledClips, training: IntArray, held_out: IntArray, points: Mapping[int, FloatArray]
) -> dict[str, Scores]:
    """Scores of the held-out rows by each method, fitted on the training rows.

    points: the `all_symbol_points` of the training rows.

    "cca" ranks by angle, as the search mode does, with the number of dimensions that the training
    rows choose. "cca-score" ranks by the probabilities that the mode reports (a fold with fewer
    training clips of a word then ranks behind others). "cca-10" is "cca" with the paper's 10
    dimensions. "printed" is Takano's retrieval as printed: 10 dimensions, the pseudo-inverse and
    the Euclidean distance; "cca-distance" has the ridge instead. "cca-symbol" is his recognition:
    a motion is represented by its most likely training symbol. This needs likelihoods. The other
    methods represent it by its own symbol.
    """
    labels = clips.labels[training]
    own_groups = [clips.groups[row] for row in training]
    frequency = np.tile(labels.mean(axis=0), (len(held_out), 1))
    who = None if clips.persons is None else [clips.persons[row] for row in training]
    model = fit_word_model(clips.inputs[training], labels)
    curve = calibrate(model, clips.inputs[training], labels, own_groups, who)
    found = default_scores(model, curve, clips.words, clips.inputs[held_out])
    count = chosen_dimensions(losses_of(clips, training, points))
    own, few = points[count], points[DIMENSIONS]
    words = fit_correlated_words(own[training], labels, own_groups, CCA)
    ridged = fit_correlated_space(few[training], labels)
    printed = fit_correlated_space(few[training], labels, ridge=0.0)
    scores = {
        PRIOR: _by_cosine(frequency),
        DEFAULT: _by_surprise(curve, found),
        CCA: _by_angle(words.space, own[held_out]),
        CCA_SCORE: _by_chance(words, own[held_out], curve),
        "cca-10": _by_angle(ridged, few[held_out]),
        "cca-distance": _by_distance(ridged, few[held_out]),
        PRINTED: _by_distance(printed, few[held_out]),
    }
    if clips.likelihoods is not None:
        likeliest = training[np.argmax(clips.likelihoods[np.ix_(held_out, training)], axis=1)]
        scores["cca-symbol"] = _by_angle(words.space, own[likeliest])
    return scores


def all_symbol_points(clips: LabeledClips, training: IntArray) -> dict[int, FloatArray]:
    """(N, d) coordinates of all clips in the symbol spaces of the training rows, by d.

    As fit_symbol_spaces, but from distances that are computed once for all folds.
    """
    rows = landmarks_among(training, len(clips.distances))
    columns = np.searchsorted(clips.landmarks, rows)
    to_landmarks = clips.distances[:, columns]
    among = to_landmarks[rows]
    return {
        count: place(to_landmarks, metric_mds(among, count))
        for count in possible_dimensions(CANDIDATES, len(training))
    }


def landmarks_among(training: IntArray, count: int, *, seed: int = 0) -> IntArray:
    """(L,) ascending landmarks among the `training` rows of `count` clips.

    As landmark_rows, but of one random order of all clips. So the folds of a library share most of
    their landmarks, and few distances are needed.
    """
    if len(training) <= MAX_WHOLE_LIBRARY:
        return np.sort(training)
    order = np.random.RandomState(seed).permutation(count)
    return np.sort(order[np.isin(order, training)][:LANDMARKS])


def losses_of(
    clips: LabeledClips, training: IntArray, points: Mapping[int, FloatArray]
) -> dict[int, float]:
    """The mean log loss of held-out words among the training rows, by number of dimensions."""
    own = {count: rows[training] for count, rows in points.items()}
    groups = [clips.groups[row] for row in training]
    return dimension_losses(own, clips.labels[training], groups)


def left_out_words(
    clips: LabeledClips, points: FloatArray, *, ridge: float, by_distance: bool
) -> FloatArray:
    """(N, V) scores of the words of each clip, by a correlated space of all other recordings.

    points: (N, d). The symbol space, which knows no words, is that of all clips.
    """
    scores = np.zeros(clips.labels.shape)
    groups = np.array(clips.groups)
    for group in dict.fromkeys(clips.groups):
        out = groups == group
        space = fit_correlated_space(points[~out], clips.labels[~out], ridge=ridge)
        words = space.word_distances if by_distance else space.word_cosines
        scores[out] = (-1.0 if by_distance else 1.0) * words(points[out])
    return scores


def _by_surprise(curve: WordCalibration, words: FloatArray) -> Scores:
    return Scores(words, _each(lambda query: -curve.joint_surprise(words[:, query > 0.0])))


def _by_chance(words: CorrelatedWords, points: FloatArray, curve: WordCalibration) -> Scores:
    """The scores of the mode "cca"; clips by the logarithm, as in the default method."""
    shares = words.to_clips.shares[None]

    def for_query(query: FloatArray) -> FloatArray:
        common = np.exp(-curve.joint_surprise(shares[:, query > 0.0]))
        return np.asarray(np.log(words.clip_scores(words.clip_distances(points, query), common)))

    return Scores(words.word_scores(points), _each(for_query))


def _by_angle(space: CorrelatedSpace, points: FloatArray) -> Scores:
    return Scores(
        space.word_cosines(points), _each(lambda query: space.clip_cosines(points, query))
    )


def _by_distance(space: CorrelatedSpace, points: FloatArray) -> Scores:
    return Scores(
        -space.word_distances(points), _each(lambda query: -space.clip_distances(points, query))
    )


def _by_cosine(words: FloatArray) -> Scores:
    return Scores(words, _each(lambda query: clip_cosines(words, query)))


def _each(score_one: Callable[[FloatArray], FloatArray]) -> Callable[[FloatArray], FloatArray]:
    """A function (queries, V) -> (queries, n) from a function for one query."""
    return lambda queries: np.array([score_one(query) for query in queries])
