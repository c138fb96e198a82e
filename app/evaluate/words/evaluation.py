"""Words for clips and clips for words (Takano, section 3), held out and in-sample."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.symbols.channels import symbol_features
from app.evaluate.charts import Curve, Format, Panel, curves_picture
from app.models.held_out.words import RECALLS, WordEvaluation, WordFigures, held_out_word_figures
from app.models.words.correlated_space import fit_correlated_space
from app.models.words.query import understand
from app.models.words.symbol_space import fit_symbol_space
from app.models.words.vocabulary import WordVocabulary
from app.motion.frame.body_frame import smooth_track
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.library.library import Library
from app.services.library.stored_motion import load_motion
from app.services.training.training_set import TrainingSet, read_training_set, ready_only
from app.store.clips.filter import ClipFilter

EXAMPLES = 4
NEAREST = 10
"""Number of rows of table 2."""
MAX_WORDS_IN_MESSAGE = 30
"""Largest number of words in a message."""
DIAGONAL = "recall = precision"


@dataclass(frozen=True, slots=True)
class NearClip:
    """A clip near a query. ratio: its distance divided by that of the nearest clip (table 2);
    carries: whether the clip carries all words of the query."""

    id: str
    name: str
    ratio: float
    carries: bool
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class WordExample:
    """The clips nearest to a query of words, in the space as printed (pseudo-inverse)."""

    words: tuple[str, ...]
    nearest: tuple[NearClip, ...]


def judge_words(lib: Library, filter: ClipFilter | None = None) -> WordEvaluation:
    """Figures of the word models and of the prior. Raises NotEnoughLabels."""
    training = read_training_set(lib.store, ready_only(filter))

    def channels(row: int) -> FloatArray:
        return symbol_features(active_part(smooth_track(load_motion(lib, training.clips[row]))))

    return held_out_word_figures(
        training.symbols,
        training.word_inputs,
        training.label_sets,
        training.groups,
        persons=training.strangers,
        sequence=channels,
    )


def word_examples(
    lib: Library, queries: Sequence[str] | None = None, filter: ClipFilter | None = None
) -> tuple[WordExample, ...]:
    """Table 2: distance ratios in the canonical space of motions, fitted on all labeled clips.

    queries: each of one or several words; by default the most frequent words.
    Raises BadField if no clip carries a word of a query, and NotEnoughLabels.
    """
    training = read_training_set(lib.store, ready_only(filter))
    rows = [row for row, words in enumerate(training.label_sets) if words]
    label_sets = [training.label_sets[row] for row in rows]
    vocabulary = WordVocabulary.of(label_sets)
    labels = vocabulary.label_matrix(label_sets)
    if queries is None:
        most_frequent = np.argsort(-labels.sum(axis=0), kind="stable")[:EXAMPLES]
        queries = [vocabulary.words[column] for column in most_frequent]
    asked = [_query_words(query, vocabulary) for query in queries]
    symbols = [training.symbols[row] for row in rows]
    points = fit_symbol_space(symbols).place(symbols) if rows else np.zeros((0, 1))
    space = fit_correlated_space(points, labels, ridge=0.0)
    found = []
    for words in asked:
        query_vector = vocabulary.vector(dict.fromkeys(words, 1.0))
        distances = space.clip_distances(points, query_vector)
        nearest = np.argsort(distances, kind="stable")[:NEAREST]
        shortest = max(float(distances[nearest[0]]), 1e-12)
        carries = labels @ query_vector >= len(words)
        near = tuple(
            _near(training, rows[row], float(distances[row]) / shortest, bool(carries[row]))
            for row in nearest
        )
        found.append(WordExample(words, near))
    return tuple(found)


def draw_words(evaluation: WordEvaluation, form: Format) -> bytes:
    """Figure 7: precision by recall of single words, held out and in-sample."""
    return curves_picture(
        [
            _panel(evaluation.figures, f"held out, {evaluation.folds} folds"),
            _panel(evaluation.in_sample, "in-sample, as the paper"),
        ],
        form,
        title=f"Clips for a word: {evaluation.clips} clips, {evaluation.words} words",
    )


def _panel(figures: Sequence[WordFigures], title: str) -> Panel:
    curves = [Curve(RECALLS[1:], np.array(one.precision[1:]), one.method) for one in figures]
    return Panel(
        [*curves, Curve(np.array([0.0, 1.0]), np.array([0.0, 1.0]), DIAGONAL)],
        title=title,
        x_label="recall",
        y_label="precision",
        y_range=(0.0, 1.02),
    )


def _query_words(query: str, vocabulary: WordVocabulary) -> tuple[str, ...]:
    asked = tuple(understand(query.split(), vocabulary, {}).weights)
    if not asked:
        known = ", ".join(vocabulary.words[:MAX_WORDS_IN_MESSAGE])
        raise fields.bad_field(
            "query", f"no clip carries a word of {query!r}; known words: {known}"
        )
    return asked


def _near(training: TrainingSet, row: int, ratio: float, carries: bool) -> NearClip:
    clip = training.clips[row]
    return NearClip(clip.id, clip.full_name, ratio, carries, clip.words)
