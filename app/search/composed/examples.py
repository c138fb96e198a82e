"""The probability that clips are of the same kind as an example."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.nearest import distances_to as vector_distances
from app.numerics.nearest import gather
from app.search.composed.by_parts import Evidence, SecondStage
from app.search.composed.likeness import (
    COSTLY_SAMPLE,
    CURVES,
    SAMPLE,
    even_sample,
    typical_distance,
)
from app.search.composed.surprise import Part
from app.search.example.by_example import fused
from app.search.example.distances import Descriptors, Loader, distances_to
from app.search.example.methods import Method
from app.search.index.rows import RowsView
from app.search.index.vector_index import VECTOR
from app.search.ranking.lower_bounds import LowerBounds
from app.search.ranking.ranking import IdArray

Scales = tuple[float, ...]
"""The typical distance of an example's vector, then that of its method if it has another unit."""


def scale_count(method: Method) -> int:
    """The number of typical distances of an example by this method."""
    return 1 if method in (Method.VECTOR, Method.FUSED) else 2


def typical_distances(query: Descriptors, method: Method, rows: RowsView, load: Loader) -> Scales:
    """The typical distances of an example, from samples of all clips in the index.

    A filter changes nothing, so that a clip has the same probability with any filter.
    """
    living = np.flatnonzero(rows.labels.alive)
    by_vector = vector_distances(rows.blocks, even_sample(living, SAMPLE), query[VECTOR])
    if scale_count(method) == 1:
        return (typical_distance(by_vector),)
    ids = rows.labels.ids[even_sample(living, COSTLY_SAMPLE)].tolist()
    return typical_distance(by_vector), typical_distance(distances_to(query, ids, method, load))


def example_evidence(
    part: Part,
    query: Descriptors,
    method: Method,
    rows: RowsView,
    numbers: IntArray,
    scales: Scales,
    load: Loader,
) -> Evidence:
    """The probabilities that the clips `numbers` (n,) of an index are like an example.

    method: any that needs no fitted model; numbers: ascending; scales: of the example.
    """
    distances = vector_distances(rows.blocks, numbers, query[VECTOR])
    fast = CURVES[Method.VECTOR].probabilities(distances, scales[0])
    if method is Method.VECTOR:
        return Evidence(part, fast)
    measured = partial(_measured, query, method, rows, load)
    likely = partial(CURVES[method].probabilities, typical=scales[-1])
    return Evidence(part, fast, SecondStage(measured, likely))


def _measured(
    query: Descriptors, method: Method, rows: RowsView, load: Loader, ids: IdArray
) -> LowerBounds:
    """The distances of clips (m,) by a method that is slower than vectors."""
    if method is Method.FUSED:
        return fused(query, ids, gather(rows.blocks, rows.labels.numbers(ids)), load)

    def measure(chosen: IntArray) -> FloatArray:
        return distances_to(query, ids[chosen].tolist(), method, load)

    return LowerBounds(ids, np.zeros(len(ids)), measure)
