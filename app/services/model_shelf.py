"""The fitted models in force, loaded when they are asked for and when a newer one is there."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, TypeVar

from app.models.correlated_space import CorrelatedSpace
from app.models.multilinear import Multilinear
from app.models.recogniser import Recogniser
from app.models.symbol_space import SymbolSpace
from app.models.word_model import WordModel
from app.models.word_vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray
from app.store import models as stored
from app.store.models import ModelRecord
from app.store.store import Store

Model = TypeVar("Model")
Arrays = Mapping[str, FloatArray]

SYMBOLS_PREFIX = "symbols_"
"""Of the symbol space's arrays within the correlated space's record."""


class ModelKind(StrEnum):
    """What is fitted on a library."""

    SYMBOL_SPACE = "symbol_space"
    """Takano's motion symbol space."""
    CORRELATED_SPACE = "correlated_space"
    """Takano's CCA of that space and the words, with the symbol space that it was fitted on."""
    WORDS = "words"
    """Kernel ridge from clip statistics to words."""
    MULTILINEAR = "multilinear"
    """Vasilescu's N-mode decomposition of persons and tasks."""
    RECOGNISER = "recogniser"
    """Who does what, with an honest unknown."""


@dataclass(frozen=True, slots=True)
class DefaultWords:
    """The default word model; id: of its record, different for each fit."""

    id: str
    vocabulary: WordVocabulary
    model: WordModel


@dataclass(frozen=True, slots=True)
class CcaModel:
    """The correlated space with the symbol space that its coordinates are of."""

    id: str
    vocabulary: WordVocabulary
    symbols: SymbolSpace
    space: CorrelatedSpace


class ModelShelf:
    """Models by kind; a cheap query each time tells whether a newer one is in force."""

    def __init__(self) -> None:
        self._loaded: dict[ModelKind, tuple[int, Any]] = {}
        self._lock = threading.Lock()

    def default_words(self, store: Store) -> DefaultWords:
        """The default word model in force; raises ModelNotFitted."""
        return self._get(store, ModelKind.WORDS, _default_words)

    def cca(self, store: Store) -> CcaModel:
        """The correlated space in force; raises ModelNotFitted."""
        return self._get(store, ModelKind.CORRELATED_SPACE, _cca)

    def recogniser(self, store: Store) -> Recogniser:
        """The default recogniser in force; raises ModelNotFitted."""
        return self._get(store, ModelKind.RECOGNISER, _recogniser)

    def multilinear(self, store: Store) -> Multilinear:
        """The multilinear model in force; raises ModelNotFitted."""
        return self._get(store, ModelKind.MULTILINEAR, _multilinear)

    def _get(
        self, store: Store, kind: ModelKind, build: Callable[[ModelRecord, Arrays], Model]
    ) -> Model:
        with store.read() as tx:
            version = stored.current_versions(tx).get(kind.value)
            with self._lock:
                held = self._loaded.get(kind)
            if held is not None and held[0] == version:
                model: Model = held[1]
                return model
            record = stored.current(tx, kind.value)
            built = build(record, stored.load_arrays(tx, record.id))
        with self._lock:
            self._loaded[kind] = (record.version, built)
        return built


def _default_words(record: ModelRecord, arrays: Arrays) -> DefaultWords:
    model = WordModel.from_arrays(arrays, record.meta["model"])
    return DefaultWords(record.id, _vocabulary(record), model)


def _cca(record: ModelRecord, arrays: Arrays) -> CcaModel:
    symbols = {
        name.removeprefix(SYMBOLS_PREFIX): array
        for name, array in arrays.items()
        if name.startswith(SYMBOLS_PREFIX)
    }
    return CcaModel(
        record.id,
        _vocabulary(record),
        SymbolSpace.from_arrays(symbols, record.meta["symbols"]),
        CorrelatedSpace.from_arrays(arrays, record.meta["model"]),
    )


def _recogniser(record: ModelRecord, arrays: Arrays) -> Recogniser:
    return Recogniser.from_arrays(arrays, record.meta["model"])


def _multilinear(record: ModelRecord, arrays: Arrays) -> Multilinear:
    return Multilinear.from_arrays(arrays, record.meta["model"])


def _vocabulary(record: ModelRecord) -> WordVocabulary:
    return WordVocabulary(tuple(record.meta["vocabulary"]))
