"""Rank clips against words by the fitted word models (Takano, section 2)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.symbols.symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.models.words.correlated_words import CCA, PRINTED
from app.models.words.library import LibraryWords
from app.models.words.query import WordQuery
from app.models.words.symbol_space import SymbolSpace
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.index import usable_arrays
from app.search.index.labels import LabelView
from app.search.index.model_rows import ModelRowsView
from app.search.ranking.ranking import Ranking
from app.services.library.fitted_models import Fitted
from app.services.library.library import Library
from app.services.library.precomputed_rows import CCA_POINTS, OUTPUTS, POINTS, read_precomputed
from app.store.clips.filter import ClipFilter

INPUTS = ("symbol_statistics", "movement_signs")
"""The arrays of a clip whose concatenation is the input of the word model."""
MIN_PROBABILITY = 0.5
"""A clip without words counts as carrying a word if the probability is at least this."""

Words = Fitted[LibraryWords]


@dataclass(frozen=True, slots=True)
class WordRanking:
    """Clips in the order in which words describe them.

    model: id of the model that ranked; asked: how the model understood the words; to_score: from
    a distance of the ranking to a score, 0..1.
    """

    ranking: Ranking
    model: str
    asked: WordQuery
    to_score: Callable[[float], float]


def rank_by_words(
    lib: Library, clips: LabelView, texts: Sequence[str], mode: str, clip_filter: ClipFilter
) -> WordRanking:
    """Rank all clips that pass the filter; no clip if the model knows none of the words.

    clips: of the library's index. texts: words, phrases or sentences. A word with a minus excludes
    the clips that carry it, and clips without words that probably carry it. If all words have a
    minus, clips are ranked by the probability that they carry none of them, in either mode.

    The score is the probability that a clip carries the requested words. The distance is -ln of it
    in mode "default"; in the correlated space (Takano, sections 2.2-2.4) it is 1 - cosine in mode
    "cca", and Euclidean in mode "printed". Raises ModelNotFitted, and NotEnoughLabels if these two
    modes could not be fitted.
    """
    fitted = lib.models.words(lib.store)
    asked = fitted.model.ask(texts)
    in_space = _is_in_space(asked, mode)
    to_score = partial(_distance_score, mode) if in_space else _probability
    if not asked.items and not asked.excluded:
        nothing = Ranking(np.empty(0, dtype=object), np.zeros(0))
        return WordRanking(nothing, fitted.id, asked, partial(to_score, fitted.model, asked))
    mask = clips.mask(clip_filter)
    if asked.excluded:
        mask &= ~probably_carries(lib, fitted, clips, asked.excluded)
    rows, distances = measure(lib, fitted, clips, mask, asked, mode)
    ranking = Ranking(clips.ids[rows], distances)
    return WordRanking(ranking, fitted.id, asked, partial(to_score, fitted.model, asked))


def measure(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordQuery, mode: str
) -> tuple[IntArray, FloatArray]:
    """Rows (k,) and distances (k,) of the clips in `mask` (n,) that the model knows.

    asked: with an item, or a word to exclude. Raises NotEnoughLabels as `rank_by_words`.
    """
    if not asked.items:
        return _by_absence(lib, fitted, clips, mask, asked)
    if _is_in_space(asked, mode):
        return _by_distance(lib, fitted, clips, mask, asked, mode)
    return _by_surprise(lib, fitted, clips, mask, asked)


def probabilities(
    model: LibraryWords, asked: WordQuery, mode: str, distances: FloatArray
) -> FloatArray:
    """(k,) the probabilities of `measure`d distances (k,)."""
    if _is_in_space(asked, mode):
        return model.distance_scores(mode, distances, asked)
    return np.asarray(np.exp(-distances))


def _is_in_space(asked: WordQuery, mode: str) -> bool:
    """Whether clips are ranked in a correlated space, which knows only words of the library."""
    return mode in (CCA, PRINTED) and bool(asked.weights)


def word_arrays(mode: str) -> tuple[str, ...]:
    """The names of the arrays of a motion from which a mode predicts its words."""
    return SYMBOL_ARRAYS if mode in (CCA, PRINTED) else INPUTS


def word_scores(model: LibraryWords, arrays: Mapping[str, FloatArray], mode: str) -> FloatArray:
    """(V,) probability that a motion has each word of the vocabulary, from its `word_arrays`.

    Raises NotEnoughLabels if mode "cca" or "printed" could not be fitted.
    """
    if mode in (CCA, PRINTED):
        points = model.space_of(mode).place([symbol_from_arrays(dict(arrays))])
        return np.asarray(model.word_scores_by(mode, points)[0])
    inputs = np.concatenate([arrays[name] for name in INPUTS])
    return np.asarray(model.word_scores(inputs[None])[0])


def clip_points(
    lib: Library, fitted: Words, clips: LabelView, mode: str = PRINTED
) -> ModelRowsView:
    """(n, d) coordinates of an index's clips in the symbol space of a mode."""
    space = fitted.model.space_of(mode)
    cache, stored = (lib.cca_points, CCA_POINTS) if mode == CCA else (lib.symbol_points, POINTS)
    return cache.of(
        clips,
        fitted.id,
        space.points.shape[1],
        partial(_symbol_points, lib, space),
        partial(read_precomputed, lib, fitted.id, stored),
    )


def _word_scores(lib: Library, fitted: Words, clips: LabelView) -> ModelRowsView:
    """(n, V + C) probabilities of the model's `columns` for an index's clips."""
    return lib.word_scores.of(
        clips,
        fitted.id,
        len(fitted.model.columns),
        partial(_predict, lib, fitted.model),
        partial(read_precomputed, lib, fitted.id, OUTPUTS),
    )


def _probability(_model: LibraryWords, _asked: WordQuery, surprise: float) -> float:
    return math.exp(-surprise)


def _distance_score(mode: str, model: LibraryWords, asked: WordQuery, distance: float) -> float:
    return float(model.distance_scores(mode, np.array([distance]), asked)[0])


def probably_carries(
    lib: Library, fitted: Words, clips: LabelView, words: Sequence[str]
) -> BoolArray:
    """(n,) whether a clip carries any of `words`; a clip without words counts if it is likely."""
    vocabulary = fitted.model.vocabulary
    columns = vocabulary.columns(words)
    # Many clips share a set of words: `codes` (n,) is the index of each clip's set in `sets`.
    codes, sets = clips.word_sets()
    carried: BoolArray = vocabulary.label_matrix(sets) > 0.0  # (sets, V)
    scores = _word_scores(lib, fitted, clips).values[:, columns]  # (n, words)
    is_likely = (scores >= MIN_PROBABILITY).any(axis=1)
    is_labeled = np.asarray(carried.any(axis=1))[codes]
    is_excluded = np.asarray(carried[:, columns].any(axis=1))[codes]
    return np.where(is_labeled, is_excluded, is_likely)


def _by_surprise(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordQuery
) -> tuple[IntArray, FloatArray]:
    """Rows (k,) and distances (k,) of the clips that pass and that the model knows."""
    names = fitted.model.columns
    columns = [names.index(name) for name in dict.fromkeys(n for item in asked.items for n in item)]
    model_rows = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(mask & model_rows.has_row)
    scores = model_rows.values[rows[:, None], columns]
    surprises = fitted.model.clip_surprises(scores, [names[c] for c in columns], asked.items)
    return rows, surprises


def _by_absence(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordQuery
) -> tuple[IntArray, FloatArray]:
    """Rows (k,), and distances (k,): -ln of the probability of carrying no excluded word."""
    model_rows = _word_scores(lib, fitted, clips)
    rows = np.flatnonzero(mask & model_rows.has_row)
    scores = model_rows.values[rows[:, None], fitted.model.vocabulary.columns(asked.excluded)]
    # The words count as independent: -ln of the product of (1 - p) is the sum of -ln(1 - p).
    return rows, -np.log1p(-scores.astype(np.float64)).sum(axis=1)


def _by_distance(
    lib: Library, fitted: Words, clips: LabelView, mask: BoolArray, asked: WordQuery, mode: str
) -> tuple[IntArray, FloatArray]:
    """Rows (k,) and distances (k,) of the clips that pass and that the model knows."""
    model_rows = clip_points(lib, fitted, clips, mode)
    rows = np.flatnonzero(mask & model_rows.has_row)
    return rows, fitted.model.clip_distances(mode, model_rows.values[rows], asked)


def _predict(lib: Library, model: LibraryWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(V + C,) scores of the model's `columns` by clip id; clips without inputs are left out."""
    with lib.store.read() as tx:
        stored = [usable_arrays.get_many(tx, clip_ids, name) for name in INPUTS]
    usable = [clip_id for clip_id in clip_ids if all(clip_id in rows for rows in stored)]
    if not usable:
        return {}
    inputs = np.hstack([np.stack([rows[clip_id] for clip_id in usable]) for rows in stored])
    return dict(zip(usable, model.all_scores(inputs), strict=True))


def _symbol_points(
    lib: Library, space: SymbolSpace, clip_ids: Sequence[str]
) -> dict[str, FloatArray]:
    """(d,) coordinates in the symbol space by clip id; clips without a symbol are left out."""
    with lib.store.read() as tx:
        stored = {name: usable_arrays.get_many(tx, clip_ids, name) for name in SYMBOL_ARRAYS}
    usable = [clip_id for clip_id in clip_ids if all(clip_id in rows for rows in stored.values())]
    symbols = [
        symbol_from_arrays({name: rows[clip_id] for name, rows in stored.items()})
        for clip_id in usable
    ]
    return dict(zip(usable, space.place(symbols), strict=True))
