"""Query by example: each labelled clip asks for the others of its task."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.errors import NotEnoughLabels
from app.models.ranking_figures import average_precision, precision_at_k
from app.search.by_example import rank_by_example
from app.search.distances import EPSILON, FEATURES, RHO, QueryArrays
from app.search.index import VECTOR
from app.search.methods import Method
from app.services.library import Library
from app.services.training import ready_only
from app.store import arrays, clip_listing, clips
from app.store.clip_filter import ClipFilter
from app.store.clip_record import ClipRecord

AT = 4
"""Precision is told among so many of the nearest."""

Progress = Callable[[int, int], None]
"""Told after each query: done, in all."""


@dataclass(frozen=True, slots=True)
class RetrievalFigures:
    """Query by example with one method; relevant is what carries the query's task.

    nearest: share of queries whose nearest clip is relevant; precision_at_4 and
    mean_average_precision: means over the queries; queries: those that have a relevant clip.
    """

    method: str
    nearest: float
    precision_at_4: float
    mean_average_precision: float
    queries: int


def judge_retrieval(
    lib: Library,
    wanted: ClipFilter | None = None,
    methods: Sequence[Method] = tuple(Method),
    progress: Progress | None = None,
) -> tuple[RetrievalFigures, ...]:
    """Each clip that passes the filter asks for the others. Raises NotEnoughLabels."""
    lib.index.catch_up(lib.store)
    labelled = _with_a_fellow(_ready_clips(lib, wanted))
    if not labelled:
        raise NotEnoughLabels("No two ready clips carry the same task.")
    total, done, found = len(labelled) * len(methods), 0, []
    for method in methods:
        rows = []
        for row in _judged(lib, labelled, method, wanted or ClipFilter()):
            rows.append(row)
            done += 1
            if progress is not None:
                progress(done, total)
        nearest, precision, average = np.mean(rows, axis=0)
        found.append(
            RetrievalFigures(
                method.value, float(nearest), float(precision), float(average), len(rows)
            )
        )
    return tuple(found)


def _ready_clips(lib: Library, wanted: ClipFilter | None) -> list[ClipRecord]:
    with lib.store.read() as tx:
        ids = sorted(clip_listing.list_ids(tx, ready_only(wanted)))
        return list(clips.get_many(tx, ids).values())


def _with_a_fellow(found: Sequence[ClipRecord]) -> list[ClipRecord]:
    """The clips whose task another one carries too."""
    tasks = [clip.task for clip in found if clip.task]
    return [clip for clip in found if clip.task and tasks.count(clip.task) > 1]


def _judged(
    lib: Library, labelled: Sequence[ClipRecord], method: Method, wanted: ClipFilter
) -> Iterator[tuple[float, float, float]]:
    """For each query: whether the nearest is relevant, precision at 4, average precision."""
    task_of = {clip.id: clip.task for clip in labelled}
    load = partial(lib.arrays.get_many, lib.store)
    for clip in labelled:
        query = _query(lib, clip)
        ranked = rank_by_example(lib.index, query, method, wanted, frozenset({clip.id}), load)
        is_relevant = np.array([task_of.get(i) == clip.task for i in ranked.ids], dtype=bool)
        closeness = -np.arange(len(is_relevant), dtype=float)
        yield (
            float(is_relevant[0]),
            precision_at_k(closeness, is_relevant, min(AT, len(is_relevant))),
            average_precision(closeness, is_relevant),
        )


def _query(lib: Library, clip: ClipRecord) -> QueryArrays:
    with lib.store.read() as tx:
        vector, features, rho, epsilon = (
            arrays.get_one(tx, clip.id, name) for name in (VECTOR, FEATURES, RHO, EPSILON)
        )
    return QueryArrays(vector, features, rho, epsilon)
