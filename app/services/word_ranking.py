"""Rank clips against words by the fitted word models (Takano, section 2; DESIGN 6)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.analysis.motion_symbol import SYMBOL_ARRAYS, symbol_from_arrays
from app.models.library_words import LibraryWords
from app.models.word_query import WordsAsked
from app.numerics.arrays import FloatArray
from app.search.rank import Ranking, ranking
from app.services.library import Library
from app.store import arrays
from app.store.clip_filter import ClipFilter

STATISTICS = "symbol_statistics"
LIKELIER_THAN_NOT = 0.5


@dataclass(frozen=True, slots=True)
class WordRanking:
    """Clips for words; model: id of the model that ranked; asked: what it took them to mean."""

    ranking: Ranking
    model: str
    asked: WordsAsked


def rank_by_words(lib: Library, texts: Sequence[str], mode: str, wanted: ClipFilter) -> WordRanking:
    """All clips that pass the filter and are not excluded; none where no word is known.

    texts: words, phrases or sentences; a word with a minus leaves out what carries it, and of
    the clips without words what the model finds likelier to carry it than not. Distance is
    1 - the model's score, so that it is comparable between queries. Raises ModelNotFitted, and
    NotEnoughLabels where mode "cca" could not be fitted.
    """
    fitted = lib.models.words(lib.store)
    asked = fitted.model.ask(texts)
    if not asked.weights:
        return WordRanking(ranking(np.empty(0, dtype=object), np.zeros(0)), fitted.id, asked)
    scores_of = _cca_scores if mode == "cca" else _default_scores
    candidates = _not_excluded(lib, fitted.id, fitted.model, wanted, asked.excluded)
    query = fitted.model.vocabulary.vector(asked.weights)
    ids, scores = scores_of(lib, fitted.id, fitted.model, candidates, query)
    return WordRanking(_ranked(ids, 1.0 - scores), fitted.id, asked)


def word_score(distance: float) -> float:
    """The model's score, 0..1, from the distance of a ranking by words."""
    return 1.0 - distance


def _not_excluded(
    lib: Library, model_id: str, model: LibraryWords, wanted: ClipFilter, excluded: Sequence[str]
) -> list[str]:
    ids = [str(clip_id) for clip_id in lib.index.candidates(wanted).ids]
    if not excluded:
        return ids
    ids, outputs = lib.word_outputs.of(model_id, ids, partial(_predict, lib, model))
    carried = model.vocabulary.label_matrix([lib.index.labels(clip_id) for clip_id in ids])
    columns = [model.vocabulary.words.index(word) for word in excluded]
    believed = np.where(carried.any(axis=1, keepdims=True), carried, outputs)
    is_in = np.flatnonzero((believed[:, columns] < LIKELIER_THAN_NOT).all(axis=1))
    return [ids[row] for row in is_in]


def _default_scores(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: list[str], query: FloatArray
) -> tuple[list[str], FloatArray]:
    ids, outputs = lib.word_outputs.of(model_id, clip_ids, partial(_predict, lib, model))
    return ids, model.clip_scores(outputs, query) if ids else np.zeros(0)


def _cca_scores(
    lib: Library, model_id: str, model: LibraryWords, clip_ids: list[str], query: FloatArray
) -> tuple[list[str], FloatArray]:
    ids, points = lib.symbol_points.of(model_id, clip_ids, partial(place_symbols, lib, model))
    return ids, model.clip_scores_cca(points, query) if ids else np.zeros(0)


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
