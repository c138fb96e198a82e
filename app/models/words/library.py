"""The word models of a library, as one record that is fitted and replaced as a whole.

It holds the vocabulary, the default word model, and the symbol space and the correlated space for
the mode `cca`, which need MIN_CLIPS labeled clips. Shapes: clips N, words V.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.words.calibration import WordCalibration, calibrate
from app.models.words.correlated_space import MIN_CLIPS, CorrelatedSpace, fit_correlated_space
from app.models.words.cosine_calibration import CosineCalibration, calibrate_cosines
from app.models.words.detectors import DETECTORS, detect, evidence
from app.models.words.language.wordnet import Meanings
from app.models.words.model import STATISTICS, WordModel, fit_word_model
from app.models.words.query import WordQuery, understand
from app.models.words.symbol_space import SymbolSpace, fit_symbol_space
from app.models.words.vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM

Arrays = dict[str, np.ndarray[Any, Any]]
_Part = WordModel | WordCalibration | SymbolSpace | CorrelatedSpace | CosineCalibration


@dataclass(frozen=True, slots=True)
class LibraryWords:
    """The fitted word models.

    vocabulary: V words; model: the default word model; calibration: of its outputs; space: of
    all symbols; correlated: None if too few clips have words; cosines, back_cosines: the
    calibrations of its angles from words to clips and from clips to words, None without it;
    meanings: related words from WordNet (app.models.words.language.wordnet), added by the
    caller of the fit.
    """

    vocabulary: WordVocabulary
    model: WordModel
    calibration: WordCalibration
    space: SymbolSpace
    correlated: CorrelatedSpace | None
    cosines: CosineCalibration | None
    back_cosines: CosineCalibration | None
    meanings: Meanings = field(default_factory=Meanings)

    def ask(self, texts: Iterable[str]) -> WordQuery:
        """The meaning of a query of words, phrases or sentences in this library."""
        return understand(texts, self.vocabulary, self.meanings.related)

    @property
    def columns(self) -> tuple[str, ...]:
        """The names of the columns of `all_scores`: the vocabulary's words, and the detectors."""
        return (*self.vocabulary.words, *DETECTORS)

    def all_scores(self, inputs: FloatArray) -> FloatArray:
        """(N, V + C) probability of each of `columns` for each clip, from inputs (N, p).

        inputs: statistics, and after them the signs of movement (see `model`).
        """
        return np.hstack([self.word_scores(inputs), detect(inputs[:, STATISTICS:])])

    def word_scores(self, inputs: FloatArray) -> FloatArray:
        """(N, V) probability that each clip has each word, from inputs (N, p)."""
        return default_scores(self.model, self.calibration, self.vocabulary.words, inputs)

    def clip_surprises(
        self, scores: FloatArray, columns: Sequence[str], items: Sequence[Mapping[str, float]]
    ) -> FloatArray:
        """(N,) -ln of the probability that a clip has all items of a query.

        scores: (N, c) word_scores of the words `columns`; items: at least one, see WordQuery. If
        several words can replace an item, only the largest product of score and weight counts.
        """
        column_of = {word: column for column, word in enumerate(columns)}
        item_scores = [
            np.max([weight * scores[:, column_of[word]] for word, weight in item.items()], axis=0)
            for item in items
        ]
        return self.calibration.joint_surprise(np.stack(item_scores, axis=1))

    def word_scores_cca(self, points: FloatArray) -> FloatArray:
        """(N, V) probability that each clip has each word, in the correlated space (Takano,
        section 2.4).

        points: (N, d) symbol coordinates. Raises NotEnoughLabels without a correlated space.
        """
        space, _, calibration = self._correlated()
        return calibration.of_words(space.word_cosines(points))

    def clip_angles(self, points: FloatArray, asked: WordQuery) -> FloatArray:
        """(N,) 1 - cosine, 0..2, between clips at symbol coordinates (N, d) and a query.

        Raises NotEnoughLabels without a correlated space.
        """
        space, *_ = self._correlated()
        return 1.0 - space.clip_cosines(points, self.vocabulary.vector(asked.weights))

    def angle_scores(self, angles: FloatArray, asked: WordQuery) -> FloatArray:
        """(N,) probability that clips at `clip_angles` (N,) have all items of a query.

        Raises NotEnoughLabels without a correlated space.
        """
        _, calibration, _ = self._correlated()
        words = self.vocabulary.words
        items = [item for item in asked.items if not set(item).isdisjoint(words)]
        common = self.clip_surprises(calibration.shares[None], words, items)
        return calibration.probabilities(1.0 - angles, np.exp(-common))

    def _correlated(self) -> tuple[CorrelatedSpace, CosineCalibration, CosineCalibration]:
        if self.correlated is None or self.cosines is None or self.back_cosines is None:
            raise NotEnoughLabels(f"The mode cca needs {MIN_CLIPS} clips that have words.")
        return self.correlated, self.cosines, self.back_cosines

    def to_arrays(self) -> tuple[Arrays, dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        parts: dict[str, _Part | None] = {
            "model": self.model,
            "calibration": self.calibration,
            "space": self.space,
            "correlated": self.correlated,
            "cosines": self.cosines,
            "back_cosines": self.back_cosines,
        }
        arrays: Arrays = {}
        meta: dict[str, Any] = {
            "words": list(self.vocabulary.words),
            "meanings": self.meanings.to_meta(),
        }
        for part, record in parts.items():
            if record is not None:
                own, meta[part] = record.to_arrays()
                arrays |= {f"{part}.{name}": array for name, array in own.items()}
        return arrays, meta

    @classmethod
    def from_arrays(
        cls, arrays: Mapping[str, np.ndarray[Any, Any]], meta: Mapping[str, Any]
    ) -> LibraryWords:
        """The record from the result of `to_arrays`. Raises ValueError on another version."""
        correlated, cosines, back = None, None, None
        if "correlated" in meta:
            own = _part(arrays, "correlated")
            correlated = CorrelatedSpace.from_arrays(own, meta["correlated"])
            cosines, back = (
                CosineCalibration.from_arrays(_part(arrays, part), meta[part])
                for part in ("cosines", "back_cosines")
            )
        return cls(
            WordVocabulary(tuple(meta["words"])),
            WordModel.from_arrays(_part(arrays, "model"), meta["model"]),
            WordCalibration.from_arrays(_part(arrays, "calibration"), meta["calibration"]),
            SymbolSpace.from_arrays(_part(arrays, "space"), meta["space"]),
            correlated,
            cosines,
            back,
            Meanings.from_meta(meta["meanings"]),
        )


def default_scores(
    model: WordModel, calibration: WordCalibration, words: Sequence[str], inputs: FloatArray
) -> FloatArray:
    """(N, V) probability that clips with `inputs` (N, p) have each of `words`."""
    signs = inputs[:, STATISTICS:]
    detected = evidence(words, signs) if signs.shape[1] else None
    return calibration.probabilities(model.outputs(inputs), model.nearest(inputs), detected)


@dataclass(frozen=True, slots=True)
class FittedWords:
    """The results of a fit: the models, and (N, d) the coordinates of the clips in the space."""

    words: LibraryWords
    points: FloatArray


def fit_library_words(
    symbols: Sequence[GaussianHMM],
    inputs: FloatArray,
    label_sets: Sequence[Sequence[str]],
    groups: Sequence[str] | None = None,
    persons: Sequence[str] | None = None,
    *,
    seed: int = 0,
) -> FittedWords:
    """Fit on all clips: symbols N, inputs (N, p) of the model, label sets N (empty: not labeled).

    groups: N, equal for files of one recording, so that copies do not bias the calibration;
    persons: N, equal for clips of one person of one source, see `calibrate`.

    Deterministic for a seed. Raises NotEnoughLabels if no clip has words.
    """
    vocabulary = WordVocabulary.of(label_sets)
    labels = vocabulary.label_matrix(label_sets)
    labeled = np.flatnonzero(labels.any(axis=1))
    rows, truth = np.asarray(inputs)[labeled], labels[labeled]
    model = fit_word_model(rows, truth, seed=seed)
    own = [str(row) if groups is None else groups[row] for row in labeled]
    who = None if persons is None else [persons[row] for row in labeled]
    calibration = calibrate(model, rows, truth, own, who, seed=seed)
    space = fit_symbol_space(symbols, seed=seed)
    points = space.place(symbols)
    correlated, cosines, back = None, None, None
    if len(labeled) >= MIN_CLIPS:
        own_points = points[labeled]
        correlated = fit_correlated_space(own_points, truth)
        cosines = calibrate_cosines(own_points, truth, own, seed=seed)
        back = calibrate_cosines(own_points, truth, own, CorrelatedSpace.word_cosines, seed=seed)
    words = LibraryWords(vocabulary, model, calibration, space, correlated, cosines, back)
    return FittedWords(words, points)


def _part(arrays: Mapping[str, np.ndarray[Any, Any]], part: str) -> Arrays:
    prefix = f"{part}."
    return {k.removeprefix(prefix): v for k, v in arrays.items() if k.startswith(prefix)}
