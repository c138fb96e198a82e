"""A map of all motions: every ready clip as a point, near to what it is like.

space "symbols": the motion symbol space (Takano, section 2.1), its ten dimensions seen along
the principal axes of the model's landmarks, which stay until the next fit; a new clip is
placed at once. space "vectors": motion vectors along their own principal axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.search.index import usable_arrays
from app.search.index.labels import LabelView
from app.search.index.vector_index import VECTOR
from app.services import fields
from app.services.find.by_words import clip_points
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

SPACES = ("symbols", "vectors")
DIMENSIONS = (2, 3)
MOST_POINTS = 100_000

SpaceName = Literal["symbols", "vectors"]


@dataclass(frozen=True, slots=True)
class Map:
    """points: (n, dimensions), a row a clip; kept: share of the space's variance that the map
    shows, 0..1; total: ready clips that pass the filter, of which n are shown; model: id of the
    model that placed them, None for vectors."""

    clips: tuple[ClipRecord, ...]
    points: FloatArray
    kept: float
    total: int
    library_version: int
    model: str | None


def draw_map(
    lib: Library,
    space: str = "symbols",
    dimensions: int = 2,
    wanted: ClipFilter | None = None,
    limit: int = 10_000,
) -> Map:
    """The map of the clips that pass a filter; where there are too many, evenly picked by id.

    Raises BadField, and ModelNotFitted for symbols before the first fit.
    """
    if space not in SPACES:
        raise fields.bad_field("space", f"must be one of {', '.join(SPACES)}")
    if dimensions not in DIMENSIONS:
        raise fields.bad_field("dimensions", "must be 2 or 3")
    if not 1 <= limit <= MOST_POINTS:
        raise fields.bad_field("limit", f"must be from 1 to {MOST_POINTS}")
    version = lib.index.catch_up(lib.store)
    every = lib.index.state[1].labels
    passing = np.flatnonzero(every.passing(wanted or ClipFilter()))
    by_id = passing[np.argsort(every.ids[passing].astype(str), kind="stable")]
    picked = by_id[_evenly(len(by_id), limit)]
    ids, points, axes, model = _placed(lib, space, every, picked, dimensions)
    seen = axes.project(points) if len(ids) else np.zeros((0, dimensions))
    with lib.store.read() as tx:
        records = clips.get_many(tx, ids)
    rows = [row for row, clip_id in enumerate(ids) if clip_id in records]
    return Map(
        clips=tuple(records[ids[row]] for row in rows),
        points=_padded(seen[rows], dimensions),
        kept=_share(points - axes.center, seen) if len(ids) else 0.0,
        total=len(passing),
        library_version=version,
        model=model,
    )


def _placed(
    lib: Library, space: str, every: LabelView, picked: IntArray, dimensions: int
) -> tuple[list[str], FloatArray, PrincipalAxes, str | None]:
    """The ids of the picked clips that are there still, their points (n, d), the axes to see
    them along."""
    if space == "symbols":
        fitted = lib.models.words(lib.store)
        axes = principal_axes(fitted.model.space.points, dimensions)
        beside = clip_points(lib, fitted, every)
        known = picked[beside.there[picked]]
        return [str(i) for i in every.ids[known]], beside.values[known], axes, fitted.id
    ids = [str(i) for i in every.ids[picked]]
    with lib.store.read() as tx:
        found = usable_arrays.get_many(tx, ids, VECTOR)
    there = [clip_id for clip_id in ids if clip_id in found]
    points = np.array([found[clip_id] for clip_id in there], dtype=np.float64)
    if not there:
        return [], points, PrincipalAxes(np.zeros(0), np.zeros((0, 0))), None
    return there, points, principal_axes(points, dimensions), None


def _evenly(count: int, limit: int) -> IntArray:
    return np.linspace(0, count - 1, min(count, limit)).round().astype(np.int64)


def _share(centred: FloatArray, seen: FloatArray) -> float:
    whole = float(np.square(centred).sum())
    return float(np.square(seen).sum()) / whole if whole > 0 else 1.0


def _padded(points: FloatArray, dimensions: int) -> FloatArray:
    """With zeros for dimensions that so few clips do not span."""
    return np.pad(points, ((0, 0), (0, dimensions - points.shape[1])))
