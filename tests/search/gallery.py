"""Motions described and compared by every method, without a store."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.analysis.analyze import describe_for_search
from app.models.metric.learned_metric import INPUTS, ClipDescriptors, Factor, MetricAxes, fit_axes
from app.motion.motion import Motion
from app.numerics.arrays import FloatArray
from app.search.example.distances import distances_to
from app.search.example.methods import Method
from app.search.index.vector_index import VECTOR
from tests.search.fused import fused_distances

Arrays = dict[str, FloatArray]
RERANKED = (Method.DTW, Method.MSV_DTW, Method.MSV_XCORR)


@dataclass(frozen=True)
class Gallery:
    """Described motions, and metrics learned from all of their labels."""

    arrays: list[Arrays]
    metrics: dict[Method, MetricAxes]

    def distances(self, query: Arrays) -> dict[Method, FloatArray]:
        """(n,) distances of all motions to a query, by method."""
        names = [str(number) for number in range(len(self.arrays))]

        def load(clip_ids: Sequence[str], name: str) -> Arrays:
            return {i: self.arrays[int(i)][name] for i in clip_ids}

        by_method = {method: distances_to(query, names, method, load) for method in RERANKED}
        vectors = np.stack([arrays[VECTOR] for arrays in self.arrays]).astype(float)
        by_method[Method.VECTOR] = np.linalg.norm(vectors - query[VECTOR], axis=1)
        by_method[Method.FUSED] = fused_distances(query[VECTOR], vectors, by_method[Method.DTW])
        for method, axes in self.metrics.items():
            points = axes.project(described(self.arrays))
            by_method[method] = np.linalg.norm(points - axes.project(described([query])), axis=1)
        return by_method


def gallery(motions: Sequence[Motion], persons: Sequence[str], tasks: Sequence[str]) -> Gallery:
    arrays = [describe_for_search(motion).arrays for motion in motions]
    factors = {
        Method.METRIC_TASK: (Factor.TASK, tasks),
        Method.METRIC_PERSON: (Factor.PERSON, persons),
    }
    metrics = {
        method: fit_axes(described(arrays), labels, factor)
        for method, (factor, labels) in factors.items()
    }
    return Gallery(arrays, metrics)


def described(arrays: Sequence[Arrays]) -> ClipDescriptors:
    return ClipDescriptors(*(np.stack([some[name] for some in arrays]) for name in INPUTS))
