"""The word methods that are compared. Each is fitted on some labeled clips and scores others."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from app.models.words.calibration import WordCalibration, calibrate
from app.models.words.correlated_space import CorrelatedSpace, fit_correlated_space
from app.models.words.cosine_calibration import CosineCalibration, calibrate_cosines
from app.models.words.library import default_scores
from app.models.words.model import clip_cosines, fit_word_model
from app.models.words.symbol_space import DIMENSIONS, landmark_rows
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.mds import metric_mds, place

PRIOR, DEFAULT, CCA_SCORE = "prior", "default", "cca-score"


@dataclass(frozen=True, slots=True)
class LabeledClips:
    """N labeled clips.

    distances: (N, N) of their symbols; inputs: (N, p) of the word model; words: V; labels: (N, V);
    groups: N, equal for files of one recording; persons: N, equal for clips of one person, or None;
    fold: (N,); likelihoods: (N, N) log likelihood of each motion under
    each symbol, None without it.
    """

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


def score(clips: LabeledClips, training: IntArray, held_out: IntArray) -> dict[str, Scores]:
    """Scores of the held-out rows by each method, fitted on the training rows.

    "cca" ranks by angle, as the search mode does. "cca-score" ranks by the probabilities that
    the mode reports (a fold with fewer training clips of a word then ranks behind others).
    "cca-distance" is Takano's retrieval as printed, by Euclidean distance; "cca-pinv" also uses
    the pseudo-inverse instead of the ridge. "cca-symbol" is his recognition: a motion is
    represented by its most likely training symbol. This needs likelihoods. The other methods
    represent it by its own symbol.
    """
    labels = clips.labels[training]
    own_groups = [clips.groups[row] for row in training]
    frequency = np.tile(labels.mean(axis=0), (len(held_out), 1))
    who = None if clips.persons is None else [clips.persons[row] for row in training]
    model = fit_word_model(clips.inputs[training], labels)
    curve = calibrate(model, clips.inputs[training], labels, own_groups, who)
    found = default_scores(model, curve, clips.words, clips.inputs[held_out])
    points = symbol_points(clips, training)
    space = fit_correlated_space(points[training], labels)
    printed = fit_correlated_space(points[training], labels, ridge=0.0)
    calibrations = tuple(
        calibrate_cosines(points[training], labels, own_groups, cosines_of)
        for cosines_of in (CorrelatedSpace.single_word_cosines, CorrelatedSpace.word_cosines)
    )
    scores = {
        PRIOR: _by_cosine(frequency),
        DEFAULT: _by_surprise(curve, found),
        "cca": _by_angle(space, points[held_out]),
        CCA_SCORE: _by_chance(space, points[held_out], calibrations, curve),
        "cca-distance": _by_distance(space, points[held_out]),
        "cca-pinv": _by_distance(printed, points[held_out]),
    }
    if clips.likelihoods is not None:
        likeliest = training[np.argmax(clips.likelihoods[np.ix_(held_out, training)], axis=1)]
        scores["cca-symbol"] = _by_angle(space, points[likeliest])
    return scores


def symbol_points(clips: LabeledClips, training: IntArray) -> FloatArray:
    """(N, d) coordinates of all clips in the symbol space of the training rows.

    As fit_symbol_space, but from distances that are computed once for all folds.
    """
    rows = training[landmark_rows(len(training))]
    landmarks = metric_mds(clips.distances[np.ix_(rows, rows)], DIMENSIONS)
    return place(clips.distances[:, rows], landmarks)


def _by_surprise(curve: WordCalibration, words: FloatArray) -> Scores:
    return Scores(words, _each(lambda query: -curve.joint_surprise(words[:, query > 0.0])))


def _by_chance(
    space: CorrelatedSpace,
    points: FloatArray,
    calibrations: tuple[CosineCalibration, ...],
    curve: WordCalibration,
) -> Scores:
    """The scores of the mode "cca"; clips by the logarithm, as in the default method.

    calibrations: of words to clips, and of clips to words.
    """
    cosines, back = calibrations

    def for_query(query: FloatArray) -> FloatArray:
        common = np.exp(-curve.joint_surprise(cosines.shares[None, query > 0.0]))
        return np.asarray(np.log(cosines.probabilities(space.clip_cosines(points, query), common)))

    return Scores(back.of_words(space.word_cosines(points)), _each(for_query))


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
