"""How the hits of a search by several parts are arranged: in groups, diverse, and not too bad."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from app.numerics.arrays import BoolArray, FloatArray, IntArray
from app.numerics.euclidean import distances as euclidean
from app.search.composed.by_parts import PartsRanking
from app.search.composed.likeness import CURVES, typical_distance
from app.search.example.fusion import SHORTLIST
from app.search.example.methods import Method
from app.search.index import facets as counted
from app.search.index.facets import Facet
from app.search.index.labels import LabelView
from app.search.index.rows import RowsView
from app.search.ranking.groups import diverse_order, firsts, in_pages
from app.search.ranking.ranking import IdArray
from app.services.curation.duplicates import duplicate_groups
from app.services.fields import bad_field
from app.services.find.arrangement import UNLABELED, Arrangement, GroupBy
from app.services.find.hits import HitGroup
from app.services.find.paging import Match, MatchPage, Paging
from app.services.library.library import Library

MAX_FACETS = 20


@dataclass(frozen=True, slots=True)
class Groups:
    """The group of each clip of an index: codes (n,), -1 for none; names by code."""

    codes: IntArray
    names: Sequence[str | None]

    @classmethod
    def of(cls, lib: Library, labels: LabelView, by: GroupBy) -> Groups:
        """The groups of the clips in a view of the index."""
        if by is not GroupBy.DUPLICATES:
            return cls(labels.coded[by.value], labels.labels.named[by.value].labels)
        codes = np.full(len(labels.ids), -1, dtype=np.int64)
        with lib.store.read() as tx:
            found = duplicate_groups(tx)
        for code, ids in enumerate(found.values()):
            numbers = labels.find(np.array(ids, dtype=object))
            codes[numbers[numbers >= 0]] = code
        return cls(codes, list(found))

    def within(self, name: str) -> BoolArray:
        """(n,) the clips of a group."""
        code = next((c for c, own in enumerate(self.names) if (own or UNLABELED) == name), None)
        return np.zeros(len(self.codes), dtype=bool) if code is None else self.codes == code


class Arranger:
    """Arranges the hits of one search."""

    def __init__(self, lib: Library, rows: RowsView, arrangement: Arrangement) -> None:
        self._rows = rows
        self._asked = arrangement
        by = arrangement.group_by
        self._groups = None if by is None else Groups.of(lib, rows.labels, by)
        name = arrangement.group
        self._group = None if self._groups is None or name is None else self._groups.within(name)
        self._counts: IntArray | None = None

    def count(self, ranking: PartsRanking, mask: BoolArray) -> BoolArray:
        """(n,) the clips in `mask` (n,), the candidates of the ranking, that are hits.

        Their groups are counted.
        """
        if self._asked.min_score > 0.0:
            mask = np.zeros(len(mask), dtype=bool)
            for ids, _ in in_pages(ranking, self._asked.max_distance):
                mask[self._rows.labels.numbers(ids)] = True
        if self._group is not None:
            mask = mask & self._group
        if self._groups is not None:
            codes = self._groups.codes[mask]
            self._counts = np.bincount(codes[codes >= 0], minlength=len(self._groups.names))
        return mask

    def page(self, ranking: PartsRanking, paging: Paging, limit: int) -> MatchPage:
        """One page of the arranged hits."""
        asked = self._asked
        if asked.group_by is None and asked.diversity == 0.0:
            page = ranking.page(paging.after, limit)
            whole = MatchPage(_matches(page.ids, page.distances), page.more, ranking.anchor)
            return whole.within(asked.max_distance)
        skipped = 0 if paging.after is None else paging.after.rank
        most = SHORTLIST if asked.diversity > 0.0 else skipped + limit + 1
        ids, distances = self._best(ranking, most)
        if asked.diversity > 0.0:
            order = diverse_order(np.exp(-distances), self._likeness(ids), asked.diversity)
            ids, distances = ids[order], distances[order]
        first = skipped
        if paging.after is not None:
            found = np.flatnonzero(ids == paging.after.clip_id)
            first = int(found[0]) + 1 if len(found) else skipped
        shown = slice(first, first + limit)
        more = len(ids) > first + limit
        return MatchPage(_matches(ids[shown], distances[shown]), more, ranking.anchor)

    def group_of(self, clip_id: str) -> HitGroup | None:
        """The group of a hit."""
        by, groups, counts = self._asked.group_by, self._groups, self._counts
        if by is None or groups is None or counts is None:
            return None
        code = int(groups.codes[self._rows.labels.numbers(np.array([clip_id], dtype=object))[0]])
        if code < 0:
            return HitGroup(by.value, None, 1)
        return HitGroup(by.value, groups.names[code] or UNLABELED, int(counts[code]))

    def _best(self, ranking: PartsRanking, most: int) -> tuple[IdArray, FloatArray]:
        """At most `most` hits, the best first: of one group, or only the best of each."""
        ids: list[IdArray] = []
        distances: list[FloatArray] = []
        seen: set[int] = set()
        count = 0
        for some, far in in_pages(ranking, self._asked.max_distance):
            places: IntArray = np.arange(len(some))
            if self._group is not None:
                places = np.flatnonzero(self._group[self._rows.labels.numbers(some)])
            elif self._groups is not None:
                places = firsts(self._groups.codes[self._rows.labels.numbers(some)], seen)
            ids.append(some[places])
            distances.append(far[places])
            count += len(places)
            if count >= most:
                break
        return np.concatenate(ids)[:most], np.concatenate(distances)[:most]

    def _likeness(self, ids: IdArray) -> FloatArray:
        """(k, k) how probably two clips show one kind of motion, by their motion vectors."""
        vectors = self._rows.vectors(self._rows.labels.numbers(ids)).astype(np.float64)
        apart = euclidean(vectors, vectors)
        pairs = apart[np.triu_indices(len(ids), 1)]
        return CURVES[Method.VECTOR].probabilities(apart, typical_distance(pairs))


def checked_facets(names: Sequence[str]) -> tuple[str, ...]:
    """Names of facets, each once. Raises BadField."""
    unknown = [name for name in names if name not in counted.NAMES]
    if unknown:
        raise bad_field(
            "facets", f"unknown: {', '.join(unknown)}; known: {', '.join(counted.NAMES)}"
        )
    if len(names) > MAX_FACETS:
        raise bad_field("facets", f"must not be more than {MAX_FACETS}")
    return tuple(dict.fromkeys(names))


def facets_of(
    labels: LabelView, mask: BoolArray, names: Sequence[str]
) -> Mapping[str, Facet] | None:
    """The facets of the clips in `mask` (n,); None if none was asked for."""
    return counted.facets(labels, np.flatnonzero(mask), names) if names else None


def _matches(ids: IdArray, distances: FloatArray) -> list[Match]:
    return [
        Match(clip_id=str(clip_id), key=str(clip_id), distance=distance)
        for clip_id, distance in zip(ids, distances.tolist(), strict=True)
    ]
