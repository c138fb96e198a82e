"""Find the parts of clips that words describe: moments at any time in a clip, or segments.

The word model looks at windows of 2 s and 4 s (`word_windows`). A moment is a peak of the
probability over time (`moments`); a segment, from one keypose to the next, has the mean
probability.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice

import numpy as np

from app.models.words.library import LibraryWords
from app.models.words.query import WordQuery as Asked
from app.numerics.arrays import FloatArray
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Position
from app.search.windows.moments import SMALLEST, Curves, nearest_moments, on_grid
from app.search.windows.overlap_merging import Candidates, FoundInterval, merge_overlapping
from app.search.windows.parts import NO_FILTER, Parts
from app.services import fields
from app.services.find.by_words import MIN_PROBABILITY, Words
from app.services.find.hits import HitPage
from app.services.find.in_windows import matches_of
from app.services.find.paging import MatchPage, Paging
from app.services.find.queries import WordQuery
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter

MODE = "default"
"""The only mode: the correlated spaces know whole clips."""


@dataclass(frozen=True, slots=True)
class FoundParts:
    """A page of parts of clips; asked: how the model understood the words."""

    page: HitPage
    asked: Asked


def find_words_in_parts(
    lib: Library, query: WordQuery, texts: tuple[str, ...], clip_filter: ClipFilter
) -> FoundParts:
    """Parts of clips in order of how well words describe them; scope "windows" or "segments".

    A word with a minus leaves out the times at which it is likelier than not. The index of clips
    must have caught up with the library. Raises BadField for another mode, ModelNotFitted.
    """
    if query.mode != MODE:
        raise fields.bad_field("mode", f"with scope {query.scope} it must be {MODE}")
    fitted = lib.models.words(lib.store)
    asked = fitted.model.ask(texts)
    if not asked.items and not asked.excluded:
        return FoundParts(HitPage((), None), asked)
    question = cursors.digest("word parts", query.scope, *texts, clip_filter, fitted.id)
    paging = Paging.at(query.cursor, question, query.clip_fields)
    curves = word_curves(lib, fitted, asked, clip_filter)
    if query.scope == "segments":
        candidates = _segments(lib, curves, clip_filter)
        found, more = merge_overlapping(candidates, query.limit, paging.after)
    else:
        found, more = _page(nearest_moments(curves), query.limit, paging.after)
    page = paging.hits(lib, MatchPage(matches_of(found), more), lambda far: math.exp(-far))
    return FoundParts(page, asked)


def word_curves(
    lib: Library, fitted: Words, asked: Asked, clip_filter: ClipFilter = NO_FILTER
) -> Curves:
    """How probable a query is over the time of each clip that passes a filter."""
    lib.word_windows.catch_up(lib.store)
    view = lib.word_windows.state[1]
    parts = Parts.of(view, clip_filter)
    model = fitted.model
    every = lib.window_words.of(view, fitted.id, len(model.columns), model.all_scores)
    values = _probabilities(model, asked, every[parts.rows])
    starts, ends = parts.starts.astype(np.float64), parts.ends.astype(np.float64)
    return on_grid(parts.ids, parts.owners, starts, ends, values)


def _probabilities(model: LibraryWords, asked: Asked, scores: FloatArray) -> FloatArray:
    """(k,) the probability of a query for parts with scores (k, V + C) of the model's `columns`."""
    excluded = scores[:, model.vocabulary.columns(asked.excluded)]
    if not asked.items:
        return np.asarray(np.prod(1.0 - excluded, axis=1))
    names = model.columns
    columns = [names.index(name) for name in dict.fromkeys(n for item in asked.items for n in item)]
    named = [names[column] for column in columns]
    likely = np.exp(-model.clip_surprises(scores[:, columns], named, asked.items))
    return np.where((excluded >= MIN_PROBABILITY).any(axis=1), 0.0, likely)


def _segments(lib: Library, curves: Curves, clip_filter: ClipFilter) -> Candidates:
    """The segments of all clips that pass the filter and that have a curve."""
    lib.segments.catch_up(lib.store)
    parts = Parts.of(lib.segments.state[1], clip_filter)
    number_of = {clip_id: number for number, clip_id in enumerate(curves.ids)}
    numbers = np.array([number_of.get(clip_id, -1) for clip_id in parts.ids], dtype=np.int64)
    own = numbers[parts.owners]
    rows = np.flatnonzero(own >= 0)
    starts, ends = parts.starts[rows].astype(np.float64), parts.ends[rows].astype(np.float64)
    means = curves.means(own[rows], starts, ends)
    distances = -np.log(np.maximum(means, SMALLEST))
    return Candidates(parts.ids, parts.owners[rows], starts, ends, distances)


def _page(
    found: Iterator[FoundInterval], count: int, after: Position | None
) -> tuple[list[FoundInterval], bool]:
    """The `count` nearest parts after a position, and whether others follow."""
    if after is not None:
        last = (after.distance, after.clip_id)
        found = (one for one in found if (one.distance, one.key) > last)
    some = list(islice(found, count + 1))
    return some[:count], len(some) > count
