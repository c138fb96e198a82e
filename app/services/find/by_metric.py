"""Rank clips by a metric that was learned from labels: clips of the same task, or of the same
person, come first."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import ModelNotFitted
from app.models.metric.learned_metric import INPUTS, ClipDescriptors, LearnedMetric
from app.numerics.arrays import FloatArray, IntArray
from app.numerics.nearest import distances_to
from app.search.example.methods import Method
from app.search.index import usable_arrays
from app.search.index.nearest_ranking import NearestRanking
from app.search.index.rows import RowsView
from app.services.find.query import Arrays
from app.services.library.fitted_models import Fitted, ModelKind
from app.services.library.library import Library
from app.services.library.precomputed_rows import POINTS, read_precomputed
from app.store.clips.filter import ClipFilter

KINDS = {
    Method.METRIC_TASK: ModelKind.METRIC_TASK,
    Method.METRIC_PERSON: ModelKind.METRIC_PERSON,
}


@dataclass(frozen=True, slots=True)
class MetricRanking:
    """A ranking by a learned metric.

    model: id of the model that ranked; digest: SHA-256 of the query's descriptors; to_score: from
    a distance to the probability that the labels are the same.
    """

    ranking: NearestRanking
    model: str
    digest: str
    to_score: Callable[[float], float]


def rank_by_metric(
    lib: Library,
    descriptors: Arrays,
    method: Method,
    clip_filter: ClipFilter,
    exclude: frozenset[str] = frozenset(),
) -> MetricRanking:
    """Rank all clips that pass the filter and are not excluded.

    The index must have caught up with the library. descriptors: the INPUTS of the query by name;
    method: one of KINDS; exclude: ids of clips. Raises ModelNotFitted.
    """
    space = MetricSpace.of(lib, method)
    found = lib.metrics[space.kind].nearest(
        space.fitted.id,
        space.project,
        space.point(descriptors),
        clip_filter,
        exclude,
        space.stored,
    )
    to_score = space.fitted.model.calibration.probability
    return MetricRanking(found, space.fitted.id, content_digest(descriptors), to_score)


def content_digest(descriptors: Arrays) -> str:
    """SHA-256 of the INPUTS of a query."""
    return hashlib.sha256(b"".join(descriptors[name].tobytes() for name in INPUTS)).hexdigest()


@dataclass(frozen=True, slots=True)
class MetricSpace:
    """A learned metric, and the coordinates in it of queries and of the clips of the index."""

    lib: Library
    kind: ModelKind
    fitted: Fitted[LearnedMetric]

    @classmethod
    def of(cls, lib: Library, method: Method) -> MetricSpace:
        """The metric of a method, one of KINDS. Raises ModelNotFitted."""
        kind = KINDS[method]
        if kind is ModelKind.METRIC_PERSON and not lib.settings.recognize_persons:
            raise ModelNotFitted("Recognizing people by how they move is switched off here.")
        return cls(lib, kind, lib.models.metric(lib.store, kind))

    def point(self, descriptors: Arrays) -> FloatArray:
        """(d,) the coordinates of a query."""
        described = ClipDescriptors(*(descriptors[name][None] for name in INPUTS))
        return np.asarray(self.fitted.model.axes.project(described)[0])

    def probabilities(self, descriptors: Arrays, rows: RowsView, numbers: IntArray) -> FloatArray:
        """(n,) probabilities that clips have the label of the query.

        rows: of the library's index; numbers: (n,) ascending, of the clips.
        """
        point = self.point(descriptors)
        points = self.lib.metrics[self.kind].rows(
            rows, self.fitted.id, len(point), self.project, self.stored
        )
        distances = distances_to(points.blocks, numbers, point)
        return self.fitted.model.calibration.probabilities(distances)

    def project(self, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
        """(d,) coordinates by clip id; clips without the arrays are left out."""
        return _project(self.lib, self.fitted.model, clip_ids)

    def stored(self) -> tuple[Sequence[str], FloatArray]:
        """The coordinates that the fit computed, see `FittedRows`."""
        return read_precomputed(self.lib, self.fitted.id, POINTS)


def _project(lib: Library, model: LearnedMetric, clip_ids: Sequence[str]) -> dict[str, FloatArray]:
    """(d,) coordinates in the metric by clip id; clips without the arrays are left out."""
    with lib.store.read() as tx:
        inputs = [usable_arrays.get_many(tx, clip_ids, name) for name in INPUTS]
    usable = [clip_id for clip_id in clip_ids if all(clip_id in rows for rows in inputs)]
    if not usable:
        return {}
    described = ClipDescriptors(
        *(np.stack([rows[clip_id] for clip_id in usable]) for rows in inputs)
    )
    return dict(zip(usable, model.axes.project(described), strict=True))
