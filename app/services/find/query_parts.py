"""The parts of a query: what its examples and its words say about the clips of the index."""

from __future__ import annotations

import hashlib
from itertools import chain

import numpy as np

from app.errors import PageNotFound
from app.kinedex_error import KinedexError, Place
from app.models.metric.learned_metric import INPUTS
from app.numerics.arrays import BoolArray, IntArray
from app.search.composed.by_parts import Evidence, PartsRanking
from app.search.composed.examples import (
    Scales,
    example_evidence,
    scale_count,
    typical_distances,
)
from app.search.composed.surprise import Part
from app.search.example.by_example import COMPARED
from app.search.example.distances import FEATURES, Loader
from app.search.example.methods import LEARNED, Method
from app.search.index.filters import as_filter
from app.search.ranking import cursor as cursors
from app.services.find.by_metric import MetricSpace, content_digest
from app.services.find.hits import Hit, PartScore
from app.services.find.paging import Paging
from app.services.find.queries import ComposedQuery, Example
from app.services.find.query import QueryDescriptors, describe
from app.services.find.word_parts import WordParts
from app.services.library.library import Library

_WORDS = Part()
"""The words together: weight 1, and for something. A word with a minus leaves clips out."""


class QueryParts:
    """The examples and the words of a query over the clips of the index at one moment.

    words: None for a query without words.
    """

    def __init__(self, lib: Library, query: ComposedQuery) -> None:
        """Describe the examples. Raises what `by_parts.find_by_parts` raises.

        query: checked, with at least one example. The index must have caught up.
        """
        self._lib = lib
        self._query = query
        self._method = Method(query.method)
        self._rows = lib.index.state[1]
        is_learned = self._method in LEARNED
        names = INPUTS if is_learned else COMPARED
        self._described = [_described(lib, one, names) for one in query.examples]
        self._metric = MetricSpace.of(lib, self._method) if is_learned else None
        labels = self._rows.labels
        self.words = WordParts.of(lib, labels, query.words, query.mode) if query.words else None

    @property
    def question(self) -> str:
        """The digest of the query, for its cursors."""
        query, metric, words = self._query, self._metric, self.words
        examples = chain.from_iterable(
            (one.part, one.source.clip_id, one.weight, one.is_against, self._content(found))
            for one, found in zip(query.examples, self._described, strict=True)
        )
        return cursors.digest(
            "parts",
            *examples,
            *query.words,
            self._method,
            as_filter(query.filter),
            query.include_self,
            metric and metric.fitted.id,
            words and (words.mode, words.fitted.id),
        )

    def ranked(self, paging: Paging) -> tuple[PartsRanking, Scales]:
        """The ranking of all clips that pass, and the scales for the cursor of the next page."""
        mask = self._candidates()
        words = self.words if self.words and self.words.asked.items else None
        numbers: IntArray
        of_words: list[Evidence]
        if words is None:
            numbers, of_words = np.flatnonzero(mask), []
        else:
            numbers, likely = words.likely(mask)
            of_words = [Evidence(_WORDS, likely)]
        scales = self._scales(paging)
        evidence = [*self._examples(numbers, scales), *of_words]
        if all(one.part.is_against for one in evidence):
            numbers = numbers[:0]  # the library knows no word that was asked for
            evidence = self._examples(numbers, scales)
        ids = self._rows.labels.ids[numbers]
        return PartsRanking(ids, evidence, paging.anchor), scales

    def example_scores(self, ranking: PartsRanking, hit: Hit) -> tuple[PartScore, ...]:
        """The scores of the examples for a hit of the ranking."""
        return tuple(
            PartScore(one.part, one.is_against, score)
            for one, score in zip(
                self._query.examples, ranking.probabilities(hit.clip.id), strict=False
            )
        )

    def _candidates(self) -> BoolArray:
        """(n,) the clips that pass the filter, are no example, and carry no word with a minus."""
        exclude = frozenset[str]().union(
            *(one.excluded_clips(include_self=self._query.include_self) for one in self._described)
        )
        mask = self._rows.labels.mask(as_filter(self._query.filter), exclude)
        return self.words.kept(mask) if self.words else mask

    def _examples(self, numbers: IntArray, scales: Scales) -> list[Evidence]:
        """The evidence of the examples for clips `numbers` (n,)."""
        if self._metric is not None:
            return [
                Evidence(
                    _part(example),
                    self._metric.probabilities(found.arrays, self._rows, numbers),
                )
                for example, found in zip(self._query.examples, self._described, strict=True)
            ]
        count = scale_count(self._method)
        return [
            example_evidence(
                _part(example),
                found.arrays,
                self._method,
                self._rows,
                numbers,
                scales[place * count : (place + 1) * count],
                self._load,
            )
            for place, (example, found) in enumerate(
                zip(self._query.examples, self._described, strict=True)
            )
        ]

    def _scales(self, paging: Paging) -> Scales:
        """The typical distances of all examples: of the cursor, else of the library now.

        So clips that are added between two pages do not shift the other hits.
        """
        if self._metric is not None:
            return ()
        if paging.after is None:
            return tuple(
                chain.from_iterable(
                    typical_distances(found.arrays, self._method, self._rows, self._load)
                    for found in self._described
                )
            )
        if len(paging.after.scales) != scale_count(self._method) * len(self._described):
            places = [Place("cursor", "this is not a cursor of this server")]
            raise PageNotFound(places=places)
        return paging.after.scales

    @property
    def _load(self) -> Loader:
        return lambda ids, name: self._lib.arrays.get_many(self._lib.store, ids, name)

    def _content(self, found: QueryDescriptors) -> str:
        if self._metric is not None:
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
