"""Figures of word prediction (Takano, section 3), held out and in-sample.

Held out: a method is fitted on all folds except one, and is scored on that fold. In-sample, as in
the paper for retrieval: it is scored on the clips of its fit. There are figures for the words of a
clip (top-3 recognition), for clips by a single word (F at recall = precision over all words, fig.
7), and for clips by the label set of each clip (MAP, eq. 20).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.folds import grouped_folds
from app.models.held_out.ranking import (
    average_precision,
    brier_score,
    calibration_error,
    f_where_recall_is_precision,
    mean_average_precision,
    precision_at_recalls,
    top_k_rate,
)
from app.models.held_out.word_methods import (
    CCA_SCORE,
    DEFAULT,
    PRINTED,
    PRIOR,
    LabeledClips,
    all_symbol_points,
    landmarks_among,
    left_out_words,
    losses_of,
    score,
)
from app.models.words.correlated_space import MIN_CLIPS, RIDGE, fit_correlated_space
from app.models.words.correlated_words import CCA, chosen_dimensions
from app.models.words.likeliest_symbols import likelihoods_of_symbols
from app.models.words.symbol_space import DIMENSIONS, symbol_distances
from app.models.words.vocabulary import WordVocabulary
from app.numerics.area_under_curve import area_under_curve
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.hmm.model import GaussianHMM

FOLDS = 5
MAX_CLIPS = 1000
"""Of larger libraries, a random subset of this many clips is judged."""

RECALLS = np.linspace(0.0, 1.0, 21)

MIN_RECORDINGS = 5
"""Recordings with a word that are needed to judge the word alone: about one in each fold."""

TOP_WORDS = 3
"""Takano counts a clip as recognized if one of its words is among this many best words."""


@dataclass(frozen=True, slots=True)
class WordFigures:
    """Figures of one method, each 0..1; precision: for single words, at the recalls RECALLS."""

    method: str
    top_3_recognition: float
    word_f: float
    set_map: float
    word_map: float
    set_f: float
    precision: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Reliability:
    """Expected calibration error and Brier score of scores for single words, and for whole
    label sets; 0 is perfect. prior_brier: the Brier score of the words' frequencies.
    """

    word_error: float
    word_brier: float
    prior_brier: float
    set_error: float
    set_brier: float


@dataclass(frozen=True, slots=True)
class JudgedWord:
    """Held-out figures of one word.

    clips, recordings: the numbers of clips and of recordings with the word. too_rare: the word
    is in fewer than MIN_RECORDINGS recordings, so its own figures are mostly chance. The
    figures over all words include it.
    """

    word: str
    clips: int
    recordings: int
    average_precision: float
    f: float
    area_under_curve: float
    too_rare: bool


@dataclass(frozen=True, slots=True)
class WordEvaluation:
    """Figures of word prediction.

    figures: held out, one for each method; clips, words, folds: their numbers; in_sample: as in
    the paper; reliability: of the held-out scores of DEFAULT and CCA_SCORE as probabilities;
    correlations: canonical correlations of all clips by kind of inverse, falling; by_word: of
    the default method, held out; left_out: top-3 recognition by a space of all other recordings,
    by the modes CCA and PRINTED, empty if it was not asked for; losses: the mean log loss of
    held-out words in the mode CCA by number of dimensions, the smallest of which it chooses.
    """

    figures: tuple[WordFigures, ...]
    clips: int
    words: int
    folds: int
    in_sample: tuple[WordFigures, ...]
    reliability: dict[str, Reliability]
    correlations: dict[str, tuple[float, ...]]
    by_word: tuple[JudgedWord, ...]
    left_out: dict[str, float]
    losses: dict[int, float]


@dataclass(frozen=True, slots=True)
class _Tables:
    """Scores of all clips by one method.

    words: (N, V) of words for each clip; singles: (V, N) of clips for each word; sets: (N, N) of
    clips for the label set of each clip.
    """

    words: FloatArray
    singles: FloatArray
    sets: FloatArray


_Part = tuple[IntArray, IntArray, dict[int, FloatArray]]


def held_out_word_figures(
    symbols: Sequence[GaussianHMM],
    inputs: FloatArray,
    label_sets: Sequence[Sequence[str]],
    groups: Sequence[str],
    *,
    persons: Sequence[str] | None = None,
    sequence: Callable[[int], FloatArray] | None = None,
    leave_one_out: bool = False,
    seed: int = 0,
) -> WordEvaluation:
    """Figures of the prior (word frequency), the default word model, and the variants of the cca
    mode (see word_methods).

    symbols: N; inputs: (N, p) of the word model; label_sets: N; groups: N, equal for files of one
    recording (see folds.recording_of); persons: N, equal for clips of one person, if known;
    sequence: a function from a row to the channels (T, D) of its motion. Without it, recognition
    through the most likely symbol is left out. leave_one_out: whether to leave one recording out at
    a time too, which takes seconds. Clips without words are left out.

    Raises NotEnoughLabels if there are too few clips to hold some out.
    """
    chosen = _chosen(label_sets, seed)
    labels = [label_sets[row] for row in chosen]
    vocabulary = WordVocabulary.of(labels)
    own_groups = [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own_groups)))
    fold = grouped_folds(own_groups, folds, seed=seed)
    everything = np.arange(len(chosen))
    parts = [(np.flatnonzero(fold != one), np.flatnonzero(fold == one)) for one in np.unique(fold)]
    own_symbols = [symbols[row] for row in chosen]
    landmarks, likelihoods = _landmarks(parts, len(chosen)), None
    if sequence is not None:
        landmarks = everything  # the likeliest symbols are found by the distances to all
    own_landmarks = [own_symbols[row] for row in landmarks]
    # the same list twice takes half the time
    all_of_them = len(landmarks) == len(own_symbols)
    distances = symbol_distances(own_symbols, own_symbols if all_of_them else own_landmarks)
    if sequence is not None:
        channels = sequence  # not None, also inside the lambda
        likelihoods = likelihoods_of_symbols(
            own_symbols, distances, lambda row: channels(int(chosen[row]))
        )
    clips = LabeledClips(
        landmarks,
        distances,
        np.asarray(inputs)[chosen],
        vocabulary.words,
        vocabulary.label_matrix(labels),
        tuple(own_groups),
        None if persons is None else tuple(persons[row] for row in chosen),
        fold,
        likelihoods,
    )
    _check_size(clips, folds)
    held_out = _tables(clips, [(*part, all_symbol_points(clips, part[0])) for part in parts])
    points = all_symbol_points(clips, everything)
    in_sample = _tables(clips, [(everything, everything, points)])
    losses = losses_of(clips, everything, points)
    chosen_points = points[chosen_dimensions(losses)]
    return WordEvaluation(
        figures=_all_figures(held_out, clips.labels),
        clips=len(chosen),
        words=len(vocabulary),
        folds=folds,
        in_sample=_all_figures(in_sample, clips.labels),
        reliability={
            name: _reliability(held_out, name, clips.labels) for name in (DEFAULT, CCA_SCORE)
        },
        correlations=_correlations(clips, {RIDGE: chosen_points, 0.0: points[DIMENSIONS]}),
        by_word=_by_word(held_out[DEFAULT].singles, clips, vocabulary.words),
        left_out=_left_out(clips, chosen_points, points[DIMENSIONS]) if leave_one_out else {},
        losses=losses,
    )


def _chosen(label_sets: Sequence[Sequence[str]], seed: int) -> IntArray:
    """Sorted rows of at most MAX_CLIPS labeled clips."""
    labeled = np.array([row for row, labels in enumerate(label_sets) if labels], dtype=np.int64)
    return np.sort(np.random.RandomState(seed).permutation(labeled)[:MAX_CLIPS])


def _landmarks(parts: Sequence[tuple[IntArray, IntArray]], count: int) -> IntArray:
    """(C,) ascending rows of all landmarks of the training rows of `parts`, and of all rows."""
    trainings = [np.arange(count), *(training for training, _ in parts)]
    return np.unique(np.concatenate([landmarks_among(rows, count) for rows in trainings]))


def _check_size(clips: LabeledClips, folds: int) -> None:
    training = len(clips.fold) - int(np.bincount(clips.fold, minlength=1).max(initial=0))
    if folds < 2 or training < MIN_CLIPS:
        raise NotEnoughLabels(f"{len(clips.fold)} labeled clips are too few to hold some out.")


def _tables(clips: LabeledClips, parts: Sequence[_Part]) -> dict[str, _Tables]:
    """Score tables by method; parts: rows to fit on, rows to score, and the `all_symbol_points`.

    The rows to score of all parts together are all rows.
    """
    count, vocabulary = clips.labels.shape
    tables: dict[str, _Tables] = {}
    for training, held_out, points in parts:
        for name, scores in score(clips, training, held_out, points).items():
            if name not in tables:
                shapes = (count, vocabulary), (vocabulary, count), (count, count)
                tables[name] = _Tables(*(np.zeros(shape) for shape in shapes))
            tables[name].words[held_out] = scores.words
            tables[name].singles[:, held_out] = scores.clips(np.eye(vocabulary))
            tables[name].sets[:, held_out] = scores.clips(clips.labels)
    return tables


def _all_figures(tables: dict[str, _Tables], labels: FloatArray) -> tuple[WordFigures, ...]:
    return tuple(_figures(name, table, labels) for name, table in tables.items())


def _figures(name: str, tables: _Tables, labels: FloatArray) -> WordFigures:
    carries = labels > 0.0
    carries_all = _carries_all(labels)
    precision = precision_at_recalls(tables.singles, carries.T, RECALLS)
    return WordFigures(
        method=name,
        top_3_recognition=top_k_rate(tables.words, carries, TOP_WORDS),
        word_f=f_where_recall_is_precision(tables.singles, carries.T),
        set_map=mean_average_precision(tables.sets, carries_all),
        word_map=mean_average_precision(tables.singles, carries.T),
        set_f=f_where_recall_is_precision(tables.sets, carries_all),
        precision=tuple(precision.tolist()),
    )


def _carries_all(labels: FloatArray) -> BoolArray:
    """(queries, N) whether each clip carries all words of the label set of another."""
    return np.asarray(labels @ labels.T >= labels.sum(axis=1)[:, None])


def _reliability(tables: dict[str, _Tables], method: str, labels: FloatArray) -> Reliability:
    own, carries, carries_all = tables[method], labels > 0.0, _carries_all(labels)
    set_scores = np.exp(own.sets)  # these methods score sets by log probabilities
    return Reliability(
        word_error=calibration_error(own.words, carries),
        word_brier=brier_score(own.words, carries),
        prior_brier=brier_score(tables[PRIOR].words, carries),
        set_error=calibration_error(set_scores, carries_all),
        set_brier=brier_score(set_scores, carries_all),
    )


def _by_word(
    singles: FloatArray, clips: LabeledClips, words: Sequence[str]
) -> tuple[JudgedWord, ...]:
    """The figures of each word, the most frequent first; singles: (V, N)."""
    judged_words = []
    for word, scores, carries in zip(words, singles, clips.labels.T > 0.0, strict=True):
        recordings = len({clips.groups[row] for row in np.flatnonzero(carries)})
        judged = JudgedWord(
            word=word,
            clips=int(carries.sum()),
            recordings=recordings,
            average_precision=average_precision(scores, carries),
            f=f_where_recall_is_precision(scores, carries),
            area_under_curve=area_under_curve(scores[carries], scores[~carries]),
            too_rare=recordings < MIN_RECORDINGS,
        )
        judged_words.append(judged)
    return tuple(sorted(judged_words, key=lambda one: (-one.clips, one.word)))


def _correlations(
    clips: LabeledClips, points: dict[float, FloatArray]
) -> dict[str, tuple[float, ...]]:
    """points: of all clips by the ridge of a space."""
    return {
        name: tuple(
            fit_correlated_space(
                points[ridge], clips.labels, ridge=ridge
            ).pair.correlations.tolist()
        )
        for name, ridge in (("ridge", RIDGE), ("pseudo_inverse", 0.0))
    }


def _left_out(clips: LabeledClips, points: FloatArray, few: FloatArray) -> dict[str, float]:
    carries = clips.labels > 0.0
    cca = left_out_words(clips, points, ridge=RIDGE, by_distance=False)
    printed = left_out_words(clips, few, ridge=0.0, by_distance=True)
    return {
        CCA: top_k_rate(cca, carries, TOP_WORDS),
        PRINTED: top_k_rate(printed, carries, TOP_WORDS),
    }
