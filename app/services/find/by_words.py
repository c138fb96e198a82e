"""Rank clips against words by the fitted word models (Takano, section 2)."""

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
from app.services.library.precomputed_rows import OUTPUTS, POINTS, read_precomputed
from app.store.clips.filter import ClipFilter

STATISTICS = "symbol_statistics"
WORD_MODES = ("default", "cca")
MIN_PROBABILITY = 0.5
"""Probability from which a clip without words is taken to carry a word."""

Words = Fitted[LibraryWords]


@dataclass(frozen=True, slots=True)
class WordRanking:
    """Clips in the order in which words describe them.

    model: id of the model that ranked; asked: how the model understood the words; to_score: from
    a distance of the ranking to a score, 0..1.
    """

    ranking: Ranking
    model: str
    asked: WordsAsked
    to_score: Callable[[float], float]


def rank_by_words(
    lib: Library, texts: Sequence[str], mode: str, clip_filter: ClipFilter
) -> WordRanking:
    """All clips that pass the filter and are not excluded; no clip if no word is known. The
    index must have caught up with the library.

    texts: words, phrases or sentences. A word with a minus leaves out the clips that carry it,
    and clips without words that would probably carry it. If all words have a minus, clips are
    ordered by the probability that they carry none of them, in either mode.

    The score is the probability that a clip carries the words that were asked for. The distance
    is -ln of it in mode "default", and 1 - cosine in mode "cca". Raises ModelNotFitted, and
    NotEnoughLabels if mode "cca" could not be fitted.
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
    mask = clips.mask(clip_filter)
    if asked.excluded:
        mask &= ~_believed_to_carry(lib, fitted, clips, asked.excluded)
    rows, distances = measure(lib, fitted, clips, mask, asked)
    return WordRanking(Ranking(clips.ids[rows], distances), fitted.id, asked, to_score)


def clip_points(lib: Library, fitted: Words, clips: LabelView) -> ModelRowsView:
    """(n, d) coordinates of an index's clips in the model's symbol space."""
    return lib.symbol_points.of(
        clips,
        fitted.id,
        fitted.model.space.points.shape[1],
        partial(_place, lib, fitted.model),
        partial(read_precomputed, lib, fitted.id, POINTS),
    )


def _word_scores(lib: Library, fitted: Words, clips: LabelView) -> ModelRowsView:
    """(n, V) probabilities that an index's clips carry the words of the vocabulary."""
    return lib.word_scores.of(
        clips,
        fitted.id,
        len(fitted.model.vocabulary),
        partial(_predict, lib, fitted.model),
        partial(read_precomputed, lib, fitted.id, OUTPUTS),
    )


def _probability(surprise: float) -> float:
    return math.exp(-surprise)


def _angle_score(model: LibraryWords, asked: WordsAsked, angle: float) -> float:
    return float(model.angle_scores(np.array([angle]), asked)[0])


def _believed_to_carry(
    lib: Library, fitted: Words, clips: LabelView, words: Sequence[str]
) -> BoolArray:
    """(n,) whether a clip carries any of `words`, or has no words at all and probably would."""
    vocabulary = fitted.model.vocabulary
    columns = vocabulary.columns(words)
    codes, sets = clips.word_sets()
    carried: BoolArray = vocabulary.label_matrix(sets) > 0.0
    scores = _word_scores(lib, fitted, clips).values[:, columns]
    is_likely = (scores >= MIN_PROBABILITY).any(axis=1)
    is_labeled = np.asarray(carried.any(axis=1))[codes]
    is_excluded = np.asarray(carried[:, columns].any(axis=1))[codes]
    return np.where(is_labeled, is_excluded, is_likely)


def _by_surprise(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """Rows (k,) and distances (k,) of the clips that pass and that the model knows."""
    words = tuple(asked.weights)
    model_rows = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(mask & model_rows.there)
    scores = model_rows.values[rows[:, None], fitted.model.vocabulary.columns(words)]
    return rows, fitted.model.clip_surprises(scores, words, asked.meant)


def _by_absence(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """As _by_surprise, but of carrying none of the excluded words."""
    model_rows = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(mask & model_rows.there)
    scores = model_rows.values[rows[:, None], fitted.model.vocabulary.columns(asked.excluded)]
    return rows, -np.log1p(-scores.astype(np.float64)).sum(axis=1)


def _by_angle(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordsAsked
) -> tuple[IntArray, FloatArray]:
    """Rows (k,) and distances (k,) of the clips that pass and that the model knows."""
    model_rows = clip_points(lib, fitted, clips)
    rows = np.flatnonzero(mask & model_rows.there)
    return rows, fitted.model.clip_angles(model_rows.values[rows], asked)


def _predict(lib: Library, model: LibraryWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(V,) scores of the vocabulary's words by clip id; clips that are gone are left out."""
    with lib.store.read() as tx:
        statistics = usable_arrays.get_many(tx, clip_ids, STATISTICS)
    if not statistics:
        return {}
    predicted = model.word_scores(np.stack(list(statistics.values())))
    return dict(zip(statistics, predicted, strict=True))


def _place(lib: Library, model: LibraryWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(d,) coordinates in the symbol space by clip id; clips that are gone are left out."""
    with lib.store.read() as tx:
        parts = {name: usable_arrays.get_many(tx, clip_ids, name) for name in SYMBOL_ARRAYS}
    there = [clip_id for clip_id in clip_ids if all(clip_id in part for part in parts.values())]
    symbols = [
        symbol_from_arrays({name: part[clip_id] for name, part in parts.items()})
        for clip_id in there
    ]
    return dict(zip(there, model.space.place(symbols), strict=True))
