"""The parts of a query: what its examples and its words say about the clips of the index."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from functools import cached_property
from itertools import chain

import numpy as np

from app.errors import PageNotFound
from app.kinedex_error import KinedexError, Place
from app.models.metric.learned_metric import INPUTS
from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.search.composed.body_parts import (
    COVER,
    SCALE_COUNT,
    part_evidence,
    part_scales,
)
from app.search.composed.by_parts import Evidence, PartsRanking
from app.search.composed.examples import (
    Scales,
    example_evidence,
    scale_count,
    typical_distances,
)
from app.search.composed.pose_sequence import same_clips
from app.search.composed.surprise import Part
from app.search.example.by_example import COMPARED
from app.search.example.distances import ACTIVE, FEATURES, Descriptors, Loader
from app.search.example.methods import LEARNED, Method
from app.search.index.facets import Facet
from app.search.index.filters import as_filter
from app.search.index.rows import RowsView
from app.search.ranking import cursor as cursors
from app.services.find.arranging import Arranger, facets_of
from app.services.find.by_metric import MetricSpace, content_digest
from app.services.find.criteria import criteria_of
from app.services.find.hits import Hit, PartScore
from app.services.find.paging import Paging
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query import QueryDescriptors, describe
from app.services.find.word_parts import WordParts
from app.services.library.library import Library

PART_COMPARED = (COVER, FEATURES, ACTIVE)
"""The arrays of an example of which a part of the body counts."""

_WORDS = Part()
"""The words together: weight 1, and for something. A word with a minus leaves clips out."""


class QueryParts:
    """The examples and the words of a query over the clips of the index at one moment.

    words: None for a query without words.
    """

    def __init__(self, lib: Library, query: ComposedQuery) -> None:
        """Describe the examples. Raises what `by_parts.find_by_parts` raises.

        query: checked. The index must have caught up.
        """
        self._lib = lib
        self._query = query
        self._method = Method(query.method)
        self._rows = lib.index.state[1]
        is_learned = self._method in LEARNED
        names = INPUTS if is_learned else COMPARED
        self._described = [
            _described(lib, one, PART_COMPARED if one.body_part else names)
            for one in query.examples
        ]
        self._criteria = criteria_of(
            lib, query.poses, query.rhythm, include_self=query.include_self
        )
        self._metric = MetricSpace.of(lib, self._method) if is_learned else None
        labels = self._rows.labels
        self.arranger = Arranger(lib, self._rows, query.arrangement)
        self.words = WordParts.of(lib, labels, query.words, query.mode) if query.words else None

    @property
    def has_words(self) -> bool:
        """Whether there are words that say what clips must have."""
        return self.words is not None and bool(self.words.asked.items)

    @property
    def question(self) -> str:
        """The digest of the query, for its cursors."""
        query, metric, words = self._query, self._metric, self.words
        examples = chain.from_iterable(
            (
                *(one.part, one.source.clip_id, one.weight, one.is_against, one.body_part),
                self._content(one, found),
            )
            for one, found in zip(query.examples, self._described, strict=True)
        )
        return cursors.digest(
            "parts",
            *examples,
            *query.words,
            *(one.key for one in self._criteria),
            self._method,
            as_filter(query.filter),
            query.include_self,
            metric and metric.fitted.id,
            words and (words.mode, words.fitted.id),
            *(() if query.arrangement.is_plain else (query.arrangement,)),
        )

    def ranked(self, paging: Paging) -> tuple[PartsRanking, Scales]:
        """The ranking of all clips that pass, and the scales for the cursor of the next page."""
        mask = self.candidates
        words = self.words if self.has_words else None
        numbers: IntArray
        of_words: list[Evidence]
        if words is None:
            numbers, of_words = np.flatnonzero(mask), []
        else:
            numbers, likely = words.likely(mask)
            of_words = [Evidence(_WORDS, likely)]
        scales = self._scales(paging)
        evidence = [*self._examples(numbers, scales), *self._judged(numbers), *of_words]
        if all(one.part.is_against for one in evidence):
            numbers = numbers[:0]  # the library knows no word that was asked for
            evidence = [Evidence(one.part, np.zeros(0)) for one in evidence]
            evidence = evidence or [Evidence(_WORDS, np.zeros(0))]
        ids = self._rows.labels.ids[numbers]
        return PartsRanking(ids, evidence, paging.anchor), scales

    def example_scores(self, ranking: PartsRanking, hit: Hit) -> tuple[PartScore, ...]:
        """The scores of the examples, the poses and the rhythm for a hit of the ranking."""
        names = [(one.part, one.is_against) for one in self._query.examples]
        names += [(one.name, one.part.is_against) for one in self._criteria]
        return tuple(
            PartScore(name, is_against, score, cost)
            for (name, is_against), score, cost in zip(
                names,
                ranking.probabilities(hit.clip.id),
                ranking.costs(hit.clip.id),
                strict=False,
            )
        )

    @cached_property
    def candidates(self) -> BoolArray:
        """(n,) the clips that pass the filter, are no example, and carry no word with a minus."""
        exclude = frozenset[str]().union(
            *(one.excluded_clips(include_self=self._query.include_self) for one in self._described),
            *(one.excluded for one in self._criteria),
        )
        mask = self._rows.labels.mask(as_filter(self._query.filter), exclude)
        return self.words.kept(mask) if self.words else mask

    def _judged(self, numbers: IntArray) -> list[Evidence]:
        """The evidence of the poses and of the rhythm for clips `numbers` (n,)."""
        return [one.evidence(self._rows, numbers) for one in self._criteria]

    def _examples(self, numbers: IntArray, scales: Scales) -> list[Evidence]:
        """The evidence of the examples for clips `numbers` (n,)."""
        found, first = [], 0
        for example, described in zip(self._query.examples, self._described, strict=True):
            stop = first + self._scale_count(example)
            found.append(self._example(example, described.arrays, numbers, scales[first:stop]))
            first = stop
        return found

    def _example(
        self, example: Example, arrays: Descriptors, numbers: IntArray, scales: Scales
    ) -> Evidence:
        part = _part(example)
        if example.body_part is not None:
            labels, ids = self._rows.labels, self._rows.labels.ids[numbers]
            summaries, view = self._summaries
            places = same_clips(labels, ids, numbers, view.labels)
            return part_evidence(
                part, example.body_part, arrays, summaries, places, scales, self._load
            )
        if self._metric is not None:
            return Evidence(part, self._metric.probabilities(arrays, self._rows, numbers))
        return example_evidence(part, arrays, self._method, self._rows, numbers, scales, self._load)

    def _scale_count(self, example: Example) -> int:
        """The number of typical distances of an example."""
        if example.body_part is not None:
            return SCALE_COUNT
        return 0 if self._metric is not None else scale_count(self._method)

    def _typical(self, example: Example, arrays: Descriptors) -> Scales:
        """The typical distances of an example in the library now."""
        if example.body_part is not None:
            return part_scales(example.body_part, arrays, *self._summaries, self._load)
        if self._metric is not None:
            return ()
        return typical_distances(arrays, self._method, self._rows, self._load)

    @cached_property
    def _summaries(self) -> tuple[FloatArray, RowsView]:
        """The summaries of poses of all clips, and the index of poses they belong to."""
        self._lib.poses.catch_up(self._lib.store)
        version, view = self._lib.poses.state
        return self._lib.pose_summaries.of(version, view), view

    def facets(self, mask: BoolArray) -> Mapping[str, Facet] | None:
        """The facets that are asked for, of the clips in `mask` (n,)."""
        return facets_of(self._rows.labels, mask, self._query.facets)

    def _scales(self, paging: Paging) -> Scales:
        """The typical distances of all examples: of the cursor, else of the library now.

        So clips that are added between two pages do not shift the other hits.
        """
        pairs = list(zip(self._query.examples, self._described, strict=True))
        if paging.after is None:
            return tuple(
                chain.from_iterable(self._typical(one, found.arrays) for one, found in pairs)
            )
        if len(paging.after.scales) != sum(self._scale_count(one) for one, _ in pairs):
            places = [Place("cursor", "this is not a cursor of this server")]
            raise PageNotFound(places=places)
        return paging.after.scales

    @property
    def _load(self) -> Loader:
        return lambda ids, name: self._lib.arrays.get_many(self._lib.store, ids, name)

    def _content(self, example: Example, found: QueryDescriptors) -> str:
        if self._metric is not None and example.body_part is None:
            return content_digest(found.arrays)
        return hashlib.sha256(found.arrays[FEATURES].tobytes()).hexdigest()


def _part(example: Example) -> Part:
    return Part(example.weight, example.is_against, is_pooled=not example.is_against)


def _described(lib: Library, example: Example, names: tuple[str, ...]) -> QueryDescriptors:
    """The descriptors of an example. A failure names the example by its place in the query."""
    try:
        return describe(lib, example.source, names)
    except KinedexError as failure:
        if example.source.clip_id is None:
            raise  # the fields of a file are fields of the whole form
        places = [Place(f"{example.part}.{one.location}", one.message) for one in failure.places]
        raise type(failure)(failure.detail, places=places) from failure
