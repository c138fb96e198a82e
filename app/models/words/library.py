"""The word models of a library, as one record that is fitted and replaced as a whole.

It holds the vocabulary, the default word model, the symbol spaces, and the correlated spaces of the
modes `cca` and `printed`, which need MIN_CLIPS labeled clips. Shapes: clips N, words V.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from app.errors import NotEnoughLabels
from app.models.words.calibration import WordCalibration, calibrate
from app.models.words.correlated_space import MIN_CLIPS
from app.models.words.correlated_words import (
    CANDIDATES,
    CCA,
    PRINTED,
    CorrelatedWords,
    chosen_dimensions,
    dimension_losses,
    fit_correlated_words,
)
from app.models.words.detectors import DETECTORS, detect, evidence
from app.models.words.language.wordnet import Meanings
from app.models.words.model import STATISTICS, WordModel, fit_word_model
from app.models.words.query import WordQuery, understand
from app.models.words.symbol_space import (
    DIMENSIONS,
    SymbolSpace,
    fit_symbol_spaces,
    possible_dimensions,
    symbol_distances,
)
from app.models.words.vocabulary import WordVocabulary
from app.numerics.arrays import FloatArray
from app.numerics.hmm.model import GaussianHMM

MAX_CHOOSING = 1000
"""The largest number of labeled clips that choose the dimensions of the mode "cca"."""

Arrays = dict[str, np.ndarray[Any, Any]]
_Part = WordModel | WordCalibration | SymbolSpace | CorrelatedWords


@dataclass(frozen=True, slots=True)
class LibraryWords:
    """The fitted word models.

    vocabulary: V words; model: the default word model; calibration: of its outputs; space: of
    all symbols, with the paper's dimensions; cca_space: with as many as the mode "cca" chose;
    cca, printed: None if too few clips have words; losses: the mean log loss of held-out words in
    the mode "cca", by the number of dimensions, from which it chose; meanings: related words from
    WordNet (app.models.words.language.wordnet), added by the caller of the fit.
    """

    vocabulary: WordVocabulary
    model: WordModel
    calibration: WordCalibration
    space: SymbolSpace
    cca_space: SymbolSpace
    cca: CorrelatedWords | None
    printed: CorrelatedWords | None
    losses: Mapping[int, float] = field(default_factory=dict)
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

    def space_of(self, mode: str) -> SymbolSpace:
        """The symbol space of the mode CCA or PRINTED."""
        return self.cca_space if mode == CCA else self.space

    def word_scores_by(self, mode: str, points: FloatArray) -> FloatArray:
        """(N, V) probability that each clip has each word, in a correlated space (Takano, section
        2.4).

        points: (N, d) coordinates in `space_of` the mode CCA or PRINTED. Raises NotEnoughLabels
        without a correlated space.
        """
        return self._correlated(mode).word_scores(points)

    def clip_distances(self, mode: str, points: FloatArray, asked: WordQuery) -> FloatArray:
        """(N,) distances of clips at `points` (N, d), as in `word_scores_by`, from a query.

        1 - cosine, 0..2, in the mode CCA; Euclidean in the mode PRINTED.
        """
        query = self.vocabulary.vector(asked.weights)
        return self._correlated(mode).clip_distances(points, query)

    def distance_scores(self, mode: str, distances: FloatArray, asked: WordQuery) -> FloatArray:
        """(N,) probability that clips at `clip_distances` (N,) have all items of a query.

        It is lowered by how far the words were stretched. Raises NotEnoughLabels without a
        correlated space.
        """
        correlated = self._correlated(mode)
        words = self.vocabulary.words
        items = [item for item in asked.items if not set(item).isdisjoint(words)]
        shares = correlated.to_clips.shares
        known = [{word: 1.0 for word in item if word in words} for item in items]
        common = self.clip_surprises(shares[None], words, known)
        sure = np.prod([max(item.values()) for item in items])
        return np.asarray(sure * correlated.clip_scores(distances, np.exp(-common)))

    def _correlated(self, mode: str) -> CorrelatedWords:
        found = self.cca if mode == CCA else self.printed
        if found is None:
            raise NotEnoughLabels(f"The mode {mode} needs {MIN_CLIPS} clips that have words.")
        return found

    def to_arrays(self) -> tuple[Arrays, dict[str, Any]]:
        """Arrays and JSON-able metadata for `from_arrays`."""
        parts: dict[str, _Part | None] = {
            "model": self.model,
            "calibration": self.calibration,
            "space": self.space,
            "cca_space": self.cca_space,
            CCA: self.cca,
            PRINTED: self.printed,
        }
        arrays: Arrays = {}
        meta: dict[str, Any] = {
            "words": list(self.vocabulary.words),
            "losses": {str(count): loss for count, loss in self.losses.items()},
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
        cca, printed = (
            CorrelatedWords.from_arrays(_part(arrays, mode), meta[mode]) if mode in meta else None
            for mode in (CCA, PRINTED)
        )
        return cls(
            WordVocabulary(tuple(meta["words"])),
            WordModel.from_arrays(_part(arrays, "model"), meta["model"]),
            WordCalibration.from_arrays(_part(arrays, "calibration"), meta["calibration"]),
            SymbolSpace.from_arrays(_part(arrays, "space"), meta["space"]),
            SymbolSpace.from_arrays(_part(arrays, "cca_space"), meta["cca_space"]),
            cca,
            printed,
            {int(count): loss for count, loss in meta["losses"].items()},
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
    """The results of a fit: the models, and the coordinates of the clips, (N, d) in the space and
    (N, d') in the one of the mode "cca"."""

    words: LibraryWords
    points: FloatArray
    cca_points: FloatArray


@dataclass(frozen=True, slots=True)
class TaughtParts:
    """M labeled parts of clips that teach the default model beside whole clips.

    inputs: (M, p); label_sets: M; groups, persons: M, as those of clips.
    """

    inputs: FloatArray
    label_sets: Sequence[Sequence[str]] = ()
    groups: Sequence[str] = ()
    persons: Sequence[str] = ()


NO_PARTS = TaughtParts(np.zeros((0, 0)))


def fit_library_words(
    symbols: Sequence[GaussianHMM],
    inputs: FloatArray,
    label_sets: Sequence[Sequence[str]],
    groups: Sequence[str] | None = None,
    persons: Sequence[str] | None = None,
    parts: TaughtParts = NO_PARTS,
    *,
    seed: int = 0,
) -> FittedWords:
    """Fit on all clips: symbols N, inputs (N, p) of the model, label sets N (empty: not labeled).

    groups: N, equal for files of one recording, so that copies do not bias the calibration;
    persons: N, equal for clips of one person of one source, see `calibrate`. parts: have no motion
    symbols, so they do not teach the correlated spaces.

    Deterministic for a seed. Raises NotEnoughLabels if no clip and no part has words.
    """
    vocabulary = WordVocabulary.of([*label_sets, *parts.label_sets])
    labels = vocabulary.label_matrix(label_sets)
    labeled = np.flatnonzero(labels.any(axis=1))
    rows, truth = np.asarray(inputs)[labeled], labels[labeled]
    own = [str(row) if groups is None else groups[row] for row in labeled]
    who = None if persons is None else [persons[row] for row in labeled]
    model, calibration = _default_model(vocabulary, (rows, truth, own, who), parts, seed)
    dimensions = possible_dimensions(CANDIDATES, len(symbols))
    spaces = dict(zip(dimensions, fit_symbol_spaces(symbols, dimensions, seed=seed), strict=True))
    distances = symbol_distances(symbols, spaces[DIMENSIONS].landmarks)
    chosen, losses, cca, printed = DIMENSIONS, {}, None, None
    if len(labeled) >= MIN_CLIPS:
        # to place clips takes most of the time, so some of them choose
        some = np.sort(np.random.RandomState(seed).permutation(len(labeled))[:MAX_CHOOSING])
        judged = {c: space.place_at(distances[labeled[some]]) for c, space in spaces.items()}
        losses = dimension_losses(judged, truth[some], [own[row] for row in some], seed=seed)
        chosen = chosen_dimensions(losses)
    points = {count: spaces[count].place_at(distances) for count in {DIMENSIONS, chosen}}
    if len(labeled) >= MIN_CLIPS:
        cca = fit_correlated_words(points[chosen][labeled], truth, own, CCA, seed=seed)
        few = points[DIMENSIONS][labeled]
        printed = fit_correlated_words(few, truth, own, PRINTED, seed=seed)
    words = LibraryWords(
        vocabulary, model, calibration, spaces[DIMENSIONS], spaces[chosen], cca, printed, losses
    )
    return FittedWords(words, points[DIMENSIONS], points[chosen])


_Labeled = tuple[FloatArray, FloatArray, list[str], list[str] | None]
"""Inputs (n, p), labels (n, V), groups n, and persons n or None."""


def _default_model(
    vocabulary: WordVocabulary, clips: _Labeled, parts: TaughtParts, seed: int
) -> tuple[WordModel, WordCalibration]:
    """The default model and its calibration, taught by clips and by parts of clips."""
    rows, truth, own, who = clips
    if parts.label_sets:
        rows = np.vstack([rows, parts.inputs])
        truth = np.vstack([truth, vocabulary.label_matrix(parts.label_sets)])
        own = [*own, *parts.groups]
        who = None if who is None else [*who, *parts.persons]
    model = fit_word_model(rows, truth, seed=seed)
    return model, calibrate(model, rows, truth, own, who, seed=seed)


def _part(arrays: Mapping[str, np.ndarray[Any, Any]], part: str) -> Arrays:
    prefix = f"{part}."
    return {k.removeprefix(prefix): v for k, v in arrays.items() if k.startswith(prefix)}
