"""Rank clips against words, and words against a clip, by the fitted word models."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.models.word_model import clip_cosines
from app.numerics.arrays import FloatArray
from app.numerics.hmm import GaussianHMM
from app.search.rank import Ranking, ranking, score
from app.services.library import Library
from app.services.model_shelf import CcaModel, DefaultWords
from app.store import arrays
from app.store.clip_filter import ClipFilter

STATISTICS = "symbol_statistics"
SYMBOL_ARRAYS = ("symbol_transitions", "symbol_means", "symbol_variances")


@dataclass(frozen=True, slots=True)
class WordRanking:
    """Clips for words; model: id of the model that ranked; unknown: words that it lacks."""

    ranking: Ranking
    model: str
    unknown: tuple[str, ...]


def rank_by_words(
    lib: Library, words: Sequence[str], mode: str, wanted: ClipFilter
) -> WordRanking:
    """All clips that pass the filter; none where no word is known. Raises ModelNotFitted."""
    if mode == "cca":
        return _by_cca(lib, words, wanted)
    model = lib.models.default_words(lib.store)
    query = model.vocabulary.query(words)
    if not query.known:
        return WordRanking(_nothing(), model.id, query.unknown)
    ids, predicted = lib.word_outputs.of(
        model.id,
        _candidates(lib, wanted),
        lambda missing: predict_words(lib, model, missing),
    )
    distances = 1.0 - clip_cosines(predicted, query.vector) if ids else np.zeros(0)
    return WordRanking(_ranked(ids, distances), model.id, query.unknown)


def word_score(mode: str, distance: float) -> float:
    """0..1: the cosine that the default mode ranks by; a falling function of cca's distance."""
    return score(distance) if mode == "cca" else max(1.0 - distance, 0.0)


def predict_words(lib: Library, model: DefaultWords, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(V,) scores of the vocabulary's words by clip id."""
    with lib.store.read() as tx:
        statistics = arrays.get_many(tx, clip_ids, STATISTICS)
    if not statistics:
        return {}
    predicted = model.model.predict(np.stack(list(statistics.values())))
    return dict(zip(statistics, predicted.astype(np.float32), strict=True))


def place_symbols(lib: Library, model: CcaModel, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(d,) coordinates in the symbol space by clip id."""
    with lib.store.read() as tx:
        parts = [arrays.get_many(tx, clip_ids, name) for name in SYMBOL_ARRAYS]
    there = [clip_id for clip_id in clip_ids if all(clip_id in part for part in parts)]
    symbols = [GaussianHMM(*(part[clip_id] for part in parts)) for clip_id in there]
    return dict(zip(there, model.symbols.place(symbols), strict=True))


def _by_cca(lib: Library, words: Sequence[str], wanted: ClipFilter) -> WordRanking:
    model = lib.models.cca(lib.store)
    query = model.vocabulary.query(words)
    if not query.known:
        return WordRanking(_nothing(), model.id, query.unknown)
    ids, points = lib.symbol_points.of(
        model.id,
        _candidates(lib, wanted),
        lambda missing: place_symbols(lib, model, missing),
    )
    distances = model.space.clip_distances(points, query.vector) if ids else np.zeros(0)
    return WordRanking(_ranked(ids, distances), model.id, query.unknown)


def _candidates(lib: Library, wanted: ClipFilter) -> list[str]:
    return list(lib.index.candidates(wanted).ids)


def _ranked(ids: list[str], distances: FloatArray) -> Ranking:
    named = np.empty(len(ids), dtype=object)
    named[:] = ids
    return ranking(named, distances)


def _nothing() -> Ranking:
    return Ranking(np.empty(0, dtype=object), np.zeros(0))
