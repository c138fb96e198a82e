"""How well words are predicted for clips that were held out (Takano, section 3).

Every method is fitted on all folds but one and scored on that one, for: the words of a
clip (top-3 recognition), clips for a single word (F where recall = precision, over all
words at once) and clips for the label set of each clip (MAP, eq. 20).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import NotEnoughLabels
from app.models.correlated_space import LEAST_CLIPS, CorrelatedSpace, fit_correlated_space
from app.models.folds import grouped_folds
from app.models.ranking_figures import (
    f_where_recall_is_precision,
    mean_average_precision,
    top_k_rate,
)
from app.models.symbol_space import DIMENSIONS, landmark_rows, symbol_distances
from app.models.word_model import clip_cosines, fit_word_model
from app.models.word_vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.hmm import GaussianHMM
from app.numerics.mds import metric_mds, place

FOLDS = 5
MOST_CLIPS = 1000
"""Larger libraries are judged on a random part of so many clips."""

TOP_WORDS = 3
"""Takano counts a clip as recognised when one of its words is among so many."""


@dataclass(frozen=True, slots=True)
class WordFigures:
    """Held-out figures of one method, each 0..1."""

    method: str
    top_3_recognition: float
    word_f: float
    set_map: float


@dataclass(frozen=True, slots=True)
class WordEvaluation:
    """figures: one a method; on so many clips, words and folds."""

    figures: tuple[WordFigures, ...]
    clips: int
    words: int
    folds: int


@dataclass(frozen=True, slots=True)
class _Clips:
    """Labelled clips: distances (N, N) of their symbols, statistics (N, p), labels (N, V),
    fold (N,).
    """

    distances: FloatArray
    statistics: FloatArray
    labels: FloatArray
    fold: IntArray


@dataclass(frozen=True, slots=True)
class _Scores:
    """words: (n, V) of each held-out clip; clips: label vectors (queries, V) -> (queries, n)."""

    words: FloatArray
    clips: Callable[[FloatArray], FloatArray]


@dataclass(frozen=True, slots=True)
class _Tables:
    """Held-out scores of all clips: words (N, V), singles (V, N), sets (N, N)."""

    words: FloatArray
    singles: FloatArray
    sets: FloatArray


def held_out_word_figures(
    symbols: Sequence[GaussianHMM],
    statistics: FloatArray,
    label_sets: Sequence[Sequence[str]],
    groups: Sequence[str],
    *,
    seed: int = 0,
) -> WordEvaluation:
    """Figures of the prior (word frequency), the default word model and the cca mode.

    symbols: N; statistics: (N, p); label_sets: N; groups: N, equal for files of one
    recording (see folds.recording_of). Clips without words are left out.
    Raises NotEnoughLabels where there are too few clips to hold some out.
    """
    chosen = _chosen(label_sets, seed)
    labels = [label_sets[row] for row in chosen]
    vocabulary = WordVocabulary.of(labels)
    own_groups = [groups[row] for row in chosen]
    folds = min(FOLDS, len(set(own_groups)))
    own_symbols = [symbols[row] for row in chosen]
    clips = _Clips(
        symbol_distances(own_symbols, own_symbols),
        np.asarray(statistics)[chosen],
        vocabulary.label_matrix(labels),
        grouped_folds(own_groups, folds, seed=seed),
    )
    _check_size(clips, folds)
    tables = _held_out_tables(clips)
    figures = tuple(_figures(name, table, clips.labels) for name, table in tables.items())
    return WordEvaluation(figures, len(chosen), len(vocabulary), folds)


def _chosen(label_sets: Sequence[Sequence[str]], seed: int) -> IntArray:
    """Rows of labelled clips, sorted; at most MOST_CLIPS."""
    labelled = np.array([row for row, labels in enumerate(label_sets) if labels], dtype=np.int64)
    return np.sort(np.random.RandomState(seed).permutation(labelled)[:MOST_CLIPS])


def _check_size(clips: _Clips, folds: int) -> None:
    training = len(clips.fold) - int(np.bincount(clips.fold, minlength=1).max(initial=0))
    if folds < 2 or training < LEAST_CLIPS:
        raise NotEnoughLabels(f"{len(clips.fold)} labelled clips are too few to hold some out.")


def _held_out_tables(clips: _Clips) -> dict[str, _Tables]:
    count, vocabulary = clips.labels.shape
    tables: dict[str, _Tables] = {}
    for fold in np.unique(clips.fold):
        held = np.flatnonzero(clips.fold == fold)
        for name, scores in _score(clips, np.flatnonzero(clips.fold != fold), held).items():
            if name not in tables:
                shapes = (count, vocabulary), (vocabulary, count), (count, count)
                tables[name] = _Tables(*(np.zeros(shape) for shape in shapes))
            tables[name].words[held] = scores.words
            tables[name].singles[:, held] = scores.clips(np.eye(vocabulary))
            tables[name].sets[:, held] = scores.clips(clips.labels)
    return tables


def _figures(name: str, tables: _Tables, labels: FloatArray) -> WordFigures:
    carries = labels > 0.0
    carries_all = labels @ labels.T >= labels.sum(axis=1)[:, None]
    return WordFigures(
        method=name,
        top_3_recognition=top_k_rate(tables.words, carries, TOP_WORDS),
        word_f=f_where_recall_is_precision(tables.singles, carries.T),
        set_map=mean_average_precision(tables.sets, carries_all),
    )


def _score(clips: _Clips, training: IntArray, held: IntArray) -> dict[str, _Scores]:
    """Scores of the held-out rows by each method, fitted on the training rows.

    cca-distance is Takano's as printed: nearest by Euclidean distance.
    """
    labels = clips.labels[training]
    frequency = np.tile(labels.mean(axis=0), (len(held), 1))
    model = fit_word_model(clips.statistics[training], labels)
    space, points = _correlated(clips, training, held)
    return {
        "prior": _by_cosine(frequency),
        "default": _by_cosine(model.predict(clips.statistics[held])),
        "cca": _Scores(
            space.word_cosines(points), _each(lambda query: space.clip_cosines(points, query))
        ),
        "cca-distance": _Scores(
            -space.word_distances(points), _each(lambda query: -space.clip_distances(points, query))
        ),
    }


def _by_cosine(words: FloatArray) -> _Scores:
    return _Scores(words, _each(lambda query: clip_cosines(words, query)))


def _each(score: Callable[[FloatArray], FloatArray]) -> Callable[[FloatArray], FloatArray]:
    """(queries, V) -> (queries, n) by a score for one query."""
    return lambda queries: np.array([score(query) for query in queries])


def _correlated(
    clips: _Clips, training: IntArray, held: IntArray
) -> tuple[CorrelatedSpace, FloatArray]:
    """The space of the training rows and where the held-out ones (n, d) lie in it.

    As fit_symbol_space does, but from distances that are computed once for all folds.
    """
    rows = training[landmark_rows(len(training))]
    landmarks = metric_mds(clips.distances[np.ix_(rows, rows)], DIMENSIONS)
    points = place(clips.distances[:, rows], landmarks)
    space = fit_correlated_space(points[training], clips.labels[training])
    return space, points[held]
