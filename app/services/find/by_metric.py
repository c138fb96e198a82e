"""Rank clips by a metric that was learned from labels: clips of the same task, or of the same
person, come first."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from app.errors import ModelNotFitted
from app.models.metric.learned_metric import INPUTS, ClipDescriptors, LearnedMetric
from app.numerics.arrays import FloatArray
from app.search.example.methods import Method
from app.search.index import usable_arrays
from app.search.index.nearest_ranking import NearestRanking
from app.services.find.query import Arrays
from app.services.library.fitted_models import ModelKind
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
    kind = KINDS[method]
    if kind is ModelKind.METRIC_PERSON and not lib.settings.recognize_persons:
        raise ModelNotFitted("Recognizing people by how they move is switched off here.")
    fitted = lib.models.metric(lib.store, kind)
    model = fitted.model
    query = model.axes.project(ClipDescriptors(*(descriptors[name][None] for name in INPUTS)))[0]
    found = lib.metrics[kind].nearest(
        fitted.id,
        partial(_project, lib, model),
        query,
        clip_filter,
        exclude,
        partial(read_precomputed, lib, fitted.id, POINTS),
    )
    content = hashlib.sha256(b"".join(descriptors[name].tobytes() for name in INPUTS)).hexdigest()
    return MetricRanking(found, fitted.id, content, model.calibration.probability)


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
