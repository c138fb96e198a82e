"""A map of all motions: every ready clip is a point, and similar clips are near each other.

Space "symbols" is the motion symbol space (Takano, section 2.1). The map shows its ten dimensions
along the principal axes of the model's landmarks. They stay the same until the next fit, and a
new clip is placed at once. Space "vectors" is that of the motion vectors, along their own
principal axes.
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
MAX_POINTS = 100_000

SpaceName = Literal["symbols", "vectors"]


@dataclass(frozen=True, slots=True)
class Map:
    """The points of n clips.

    points: (n, dimensions), one row for each clip; kept: share of the space's variance that the
    map shows, 0..1; total: number of ready clips that pass the filter, of which n are shown;
    model: id of the model that placed them, None for vectors.
    """

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
    clip_filter: ClipFilter | None = None,
    limit: int = 10_000,
) -> Map:
    """The map of the clips that pass a filter. If there are more than `limit`, it shows as many,
    evenly spaced in the order of ids.

    Raises BadField, and ModelNotFitted for symbols before the first fit.
    """
    if space not in SPACES:
        raise fields.bad_field("space", f"must be one of {', '.join(SPACES)}")
    if dimensions not in DIMENSIONS:
        raise fields.bad_field("dimensions", "must be 2 or 3")
    if not 1 <= limit <= MAX_POINTS:
        raise fields.bad_field("limit", f"must be from 1 to {MAX_POINTS}")
    version = lib.index.catch_up(lib.store)
    every = lib.index.state[1].labels
    passed = np.flatnonzero(every.mask(clip_filter or ClipFilter()))
    by_id = passed[np.argsort(every.ids[passed].astype(str), kind="stable")]
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
        total=len(passed),
        library_version=version,
        model=model,
    )


def _placed(
    lib: Library, space: str, every: LabelView, picked: IntArray, dimensions: int
) -> tuple[list[str], FloatArray, PrincipalAxes, str | None]:
    """Of the picked clips that still exist: ids, points (n, d), the axes to show them along, and
    the id of the model (None for vectors)."""
    if space == "symbols":
        fitted = lib.models.words(lib.store)
        axes = principal_axes(fitted.model.space.points, dimensions)
        model_rows = clip_points(lib, fitted, every)
        known = picked[model_rows.has_row[picked]]
        return [str(i) for i in every.ids[known]], model_rows.values[known], axes, fitted.id
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
    """Zeros added for dimensions that so few clips do not span."""
    return np.pad(points, ((0, 0), (0, dimensions - points.shape[1])))
