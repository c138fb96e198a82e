"""Rank clips against words by the fitted word models (Takano, section 2; DESIGN 6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.symbols.symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.models.words.library import LibraryWords
from app.models.words.query import WordsAsked
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.index import usable_arrays
from app.search.index.labels import LabelView
from app.search.index.model_rows import ModelRowsView
from app.search.ranking.ranking import Ranking
from app.services.library.fitted_models import Fitted
from app.services.library.library import Library
from app.services.library.precomputed_rows import OUTPUTS, POINTS, read_known
from app.store.clips.filter import ClipFilter

STATISTICS = "symbol_statistics"
WORD_MODES = ("default", "cca")
LIKELIER_THAN_NOT = 0.5

Words = Fitted[LibraryWords]


@dataclass(frozen=True, slots=True)
class WordRanking:
    """Clips for words; model: id of the model that ranked; asked: what it took them to mean;
    to_score: a distance of the ranking as a score, 0..1.
    """

    ranking: Ranking
    model: str
    asked: WordsAsked
    to_score: Callable[[float], float]


def rank_by_words(lib: Library, texts: Sequence[str], mode: str, wanted: ClipFilter) -> WordRanking:
    """All clips that pass the filter and are not excluded; none where no word is known. The
    index has caught up. Where all that is asked is to leave words out, the clips stand in order
    of how likely they carry none of them, by the default in either mode.

    texts: words, phrases or sentences; a word with a minus leaves out what carries it, and of
    the clips without words what the model finds likelier to carry it than not. The default
    score is the probability that the clip carries what was asked for, its distance -ln of that;
    of "cca" too it is a probability, its distance 1 - cosine. Raises ModelNotFitted, and
    NotEnoughLabels where mode "cca" could not be fitted.
    """
    fitted = lib.models.words(lib.store)
    asked = fitted.model.ask(texts)
    clips = lib.index.state[1].labels
    measure, to_score = _by_surprise, _probability
    if not asked.weights:
        measure = _by_absence
    elif mode == "cca":
        measure, to_score = _by_angle, partial(_angle_score, fitted.model, asked)
    if not asked.weights and not asked.excluded:
        nothing = Ranking(np.empty(0, dtype=object), np.zeros(0))
        return WordRanking(nothing, fitted.id, asked, to_score)
    passing = clips.mask(wanted)
    if asked.excluded:
        passing &= ~_believed_to_carry(lib, fitted, clips, asked.excluded)
    rows, distances = measure(lib, fitted, clips, passing, asked)
    return WordRanking(Ranking(clips.ids[rows], distances), fitted.id, asked, to_score)


def clip_points(lib: Library, fitted: Words, clips: LabelView) -> ModelRowsView:
    """(n, d) coordinates of an index's clips in the model's symbol space."""
    return lib.symbol_points.of(
        clips,
        fitted.id,
        fitted.model.space.points.shape[1],
        partial(_place, lib, fitted.model),
        partial(read_known, lib, fitted.id, POINTS),
    )


def _word_scores(lib: Library, fitted: Words, clips: LabelView) -> ModelRowsView:
    """(n, V) probabilities that an index's clips carry the words of the vocabulary."""
    return lib.word_scores.of(
        clips,
        fitted.id,
        len(fitted.model.vocabulary),
        partial(_predict, lib, fitted.model),
        partial(read_known, lib, fitted.id, OUTPUTS),
    )


def _probability(surprise: float) -> float:
    return math.exp(-surprise)


def _angle_score(model: LibraryWords, asked: WordsAsked, angle: float) -> float:
    return float(model.angle_scores(np.array([angle]), asked)[0])


def _believed_to_carry(
    lib: Library, fitted: Words, clips: LabelView, words: Sequence[str]
) -> BoolArray:
    """(n,) whether a clip carries any of `words`, or has none at all and likely would."""
    vocabulary = fitted.model.vocabulary
    columns = vocabulary.columns(words)
    codes, sets = clips.word_sets()
    carried: BoolArray = vocabulary.label_matrix(sets) > 0.0
    scores = _word_scores(lib, fitted, clips).values[:, columns]
    is_likely = (scores >= LIKELIER_THAN_NOT).any(axis=1)
    is_labelled = np.asarray(carried.any(axis=1))[codes]
    is_excluded = np.asarray(carried[:, columns].any(axis=1))[codes]
    return np.where(is_labelled, is_excluded, is_likely)


def _by_surprise(
    lib: Library, fitted: Words, clips: LabelView, passing: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """Of the clips that pass and are known: their rows and distances."""
    words = tuple(asked.weights)
    beside = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(passing & beside.there)
    scores = beside.values[rows[:, None], fitted.model.vocabulary.columns(words)]
    return rows, fitted.model.clip_surprises(scores, words, asked.meant)


def _by_absence(
    lib: Library, fitted: Words, clips: LabelView, passing: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """As _by_surprise, that clips carry none of the excluded words."""
    beside = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(passing & beside.there)
    scores = beside.values[rows[:, None], fitted.model.vocabulary.columns(asked.excluded)]
    return rows, -np.log1p(-scores.astype(np.float64)).sum(axis=1)


def _by_angle(
    lib: Library, fitted: Words, clips: LabelView, passing: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """Of the clips that pass and are known: their rows and distances."""
    beside = clip_points(lib, fitted, clips)
    rows = np.flatnonzero(passing & beside.there)
    return rows, fitted.model.clip_angles(beside.values[rows], asked)


def _predict(lib: Library, model: LibraryWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(V,) scores of the vocabulary's words by clip id."""
    with lib.store.read() as tx:
        statistics = usable_arrays.get_many(tx, clip_ids, STATISTICS)
    if not statistics:
        return {}
    predicted = model.word_scores(np.stack(list(statistics.values())))
    return dict(zip(statistics, predicted, strict=True))


def _place(lib: Library, model: LibraryWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(d,) coordinates in the symbol space by clip id."""
    with lib.store.read() as tx:
        parts = {name: usable_arrays.get_many(tx, clip_ids, name) for name in SYMBOL_ARRAYS}
    there = [clip_id for clip_id in clip_ids if all(clip_id in part for part in parts.values())]
    symbols = [
        symbol_from_arrays({name: part[clip_id] for name, part in parts.items()})
        for clip_id in there
    ]
    return dict(zip(there, model.space.place(symbols), strict=True))
