"""Rank clips against words by the fitted word models (Takano, section 2; DESIGN 6)."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.motion_symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.models.library_words import LibraryWords
from app.models.word_query import WordsAsked
from app.numerics.arrays import FloatArray
from app.search.rank import Ranking, ranking
from app.services.known_clips import OUTPUTS, POINTS, read_known
from app.services.library import Library
from app.store import arrays
from app.store.clip_filter import ClipFilter

STATISTICS = "symbol_statistics"
LIKELIER_THAN_NOT = 0.5


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
    """All clips that pass the filter and are not excluded; none where no word is known.

    texts: words, phrases or sentences; a word with a minus leaves out what carries it, and of
    the clips without words what the model finds likelier to carry it than not. The default
    score is the probability that the clip carries what was asked for, its distance -ln of that;
    of "cca" it is (1 + cosine) / 2, its distance 1 - score. Raises ModelNotFitted, and
    NotEnoughLabels where mode "cca" could not be fitted.
    """
    fitted = lib.models.words(lib.store)
    asked = fitted.model.ask(texts)
    rank, to_score = (_by_angle, _complement) if mode == "cca" else (_by_surprise, _probability)
    if not asked.weights:
        nothing = ranking(np.empty(0, dtype=object), np.zeros(0))
        return WordRanking(nothing, fitted.id, asked, to_score)
    candidates = _not_excluded(lib, fitted.id, fitted.model, wanted, asked.excluded)
    ids, distances = rank(lib, fitted.id, fitted.model, candidates, asked)
    return WordRanking(_ranked(ids, distances), fitted.id, asked, to_score)


def clip_points(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: Sequence[str]
) -> tuple[list[str], FloatArray]:
    """The ids that exist, and their coordinates (n, d) in the model's symbol space."""
    place = partial(place_symbols, lib, model)
    known = partial(read_known, lib, model_id, POINTS)
    return lib.symbol_points.of(model_id, clip_ids, place, known)


def _clip_outputs(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: list[str], words: Sequence[str]
) -> tuple[list[str], FloatArray]:
    """The ids that exist, and (n, words) probabilities that they carry these words."""
    predict, known = partial(_predict, lib, model), partial(read_known, lib, model_id, OUTPUTS)
    columns = [model.vocabulary.words.index(word) for word in words]
    return lib.word_outputs.of(model_id, clip_ids, predict, known, columns)


def _probability(surprise: float) -> float:
    return math.exp(-surprise)


def _complement(distance: float) -> float:
    return 1.0 - distance


def _not_excluded(
    lib: Library, model_id: str, model: LibraryWords, wanted: ClipFilter, excluded: Sequence[str]
) -> list[str]:
    ids = [str(clip_id) for clip_id in lib.index.candidates(wanted).ids]
    if not excluded:
        return ids
    ids, outputs = _clip_outputs(lib, model_id, model, ids, excluded)
    carried = model.vocabulary.label_matrix([lib.index.labels(clip_id) for clip_id in ids])
    columns = [model.vocabulary.words.index(word) for word in excluded]
    is_labelled = carried.any(axis=1, keepdims=True)
    believed = np.where(is_labelled, carried[:, columns], outputs)
    is_in = np.flatnonzero((believed < LIKELIER_THAN_NOT).all(axis=1))
    return [ids[row] for row in is_in]


def _by_surprise(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: list[str], asked: WordsAsked
) -> tuple[list[str], FloatArray]:
    words = tuple(asked.weights)
    ids, outputs = _clip_outputs(lib, model_id, model, clip_ids, words)
    return ids, model.clip_surprises(outputs, words, asked.meant) if ids else np.zeros(0)


def _by_angle(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: list[str], asked: WordsAsked
) -> tuple[list[str], FloatArray]:
    query = model.vocabulary.vector(asked.weights)
    ids, points = clip_points(lib, model_id, model, clip_ids)
    return ids, 1.0 - model.clip_scores_cca(points, query) if ids else np.zeros(0)


def _predict(lib: Library, model: LibraryWords, clip_ids: list[str]) -> dict[str, FloatArray]:
    """(V,) scores of the vocabulary's words by clip id."""
    with lib.store.read() as tx:
        statistics = arrays.get_many(tx, clip_ids, STATISTICS)
    if not statistics:
        return {}
    predicted = model.word_scores(np.stack(list(statistics.values())))
    return dict(zip(statistics, predicted, strict=True))


def place_symbols(lib: Library, model: LibraryWords, clip_ids: list[str]) -> dict[str, FloatArray]:
    """(d,) coordinates in the symbol space by clip id."""
    with lib.store.read() as tx:
        parts = {name: arrays.get_many(tx, clip_ids, name) for name in SYMBOL_ARRAYS}
    there = [clip_id for clip_id in clip_ids if all(clip_id in part for part in parts.values())]
    symbols = [
        symbol_from_arrays({name: part[clip_id] for name, part in parts.items()})
        for clip_id in there
    ]
    return dict(zip(there, model.space.place(symbols), strict=True))


def _ranked(ids: list[str], distances: FloatArray) -> Ranking:
    named = np.empty(len(ids), dtype=object)
    named[:] = ids
    return ranking(named, distances)
