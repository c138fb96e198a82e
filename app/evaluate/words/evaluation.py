"""Words for clips and clips for words (Takano, section 3), held out and in-sample."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.analysis.descriptors.active_part import active_part
from app.analysis.symbols.channels import symbol_features
from app.evaluate.charts import Curve, Format, Panel, curves_picture
from app.models.held_out.words import RECALLS, WordEvaluation, WordFigures, held_out_word_figures
from app.models.words.correlated_space import fit_correlated_space
from app.models.words.query import WordQuery, understand
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


PAPER = {"set_f": 0.598, "set_map": 0.822, "top_3_left_out": 0.72}
"""Takano's figures for 618 motions and 253 words (section 3). F and MAP are of label sets, on the
motions that were taught; recognition leaves one motion out."""
NOTHING = 1e-6
"""A distance below this share of the mean distance of all clips is none."""


@dataclass(frozen=True, slots=True)
class NearClip:
    """A clip near a query. ratio: its distance divided by that of the nearest clip (table 2), None
    if the nearest clip lies at the query itself; carries: whether the clip carries each word of
    the query or one that means the same."""

    id: str
    name: str
    distance: float
    ratio: float | None
    carries: bool
    words: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class WordExample:
    """The clips nearest to a query of words, in the space as printed (pseudo-inverse).

    expanded: what replaced a word that no clip carries.
    """

    words: tuple[str, ...]
    nearest: tuple[NearClip, ...]
    expanded: Mapping[str, tuple[str, ...]]


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
        leave_one_out=True,
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
    asked = [_asked(query, vocabulary) for query in queries]
    symbols = [training.symbols[row] for row in rows]
    points = fit_symbol_space(symbols).place(symbols) if rows else np.zeros((0, 1))
    space = fit_correlated_space(points, labels, ridge=0.0)
    found = []
    for one, query in zip(asked, queries, strict=True):
        distances = space.clip_distances(points, vocabulary.vector(one.weights))
        nearest = np.argsort(distances, kind="stable")[:NEAREST]
        shortest = float(distances[nearest[0]])
        is_ratio = shortest > NOTHING * float(distances.mean())
        carries = np.all(
            [labels[:, vocabulary.columns(item)].any(axis=1) for item in one.items], axis=0
        )
        near = tuple(
            _near(
                training,
                rows[row],
                float(distances[row]),
                float(distances[row]) / shortest if is_ratio else None,
                carries=bool(carries[row]),
            )
            for row in nearest
        )
        found.append(WordExample(tuple(query.split()), near, one.expanded))
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


def _asked(query: str, vocabulary: WordVocabulary) -> WordQuery:
    """The query in words of the library alone: the space knows no detectors."""
    asked = understand([query], vocabulary, {})
    own = set(vocabulary.words)
    items = tuple(item for item in asked.items if own.issuperset(item))
    if not items:
        known = ", ".join(vocabulary.words[:MAX_WORDS_IN_MESSAGE])
        raise fields.bad_field(
            "query", f"no clip carries a word of {query!r}; known words: {known}"
        )
    return replace(asked, items=items)


def _near(
    training: TrainingSet, row: int, distance: float, ratio: float | None, *, carries: bool
) -> NearClip:
    clip = training.clips[row]
    return NearClip(clip.id, clip.full_name, distance, ratio, carries, clip.words)
