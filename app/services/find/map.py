"""A map of all motions: every ready clip is a point, and similar clips are near each other.

Space "symbols" is the motion symbol space (Takano, section 2.1). The map shows its ten dimensions
along the principal axes of the model's landmarks. The axes stay the same until the next fit, and a
new clip gets its point at once. Space "vectors" is the space of the motion vectors; the map shows
it along their own principal axes.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.numerics.principal_axes import PrincipalAxes, principal_axes
from app.search.index.labels import LabelView
from app.search.index.rows import RowsView
from app.services import fields
from app.services.find.by_words import clip_points
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.store.clips import repository as clips
from app.store.clips.filter import ClipFilter
from app.store.clips.record import ClipRecord

SPACES = ("symbols", "vectors")
DIMENSIONS = (2, 3)
MAX_POINTS = 100_000

SpaceName = Literal["symbols", "vectors"]


@dataclass(frozen=True, slots=True)
class Placed:
    """The points of n clips of the index.

    labels: of the clips of the index; numbers: (n,) the clips' numbers there; points: (n,
    dimensions); kept: share of the space's variance that the map shows, 0..1; total: number of
    ready clips that pass the filter, of which n are shown; model: id of the model that computed
    the points, None for vectors.
    """

    labels: LabelView
    numbers: IntArray
    points: FloatArray
    kept: float
    total: int
    library_version: int
    model: str | None

    @property
    def ids(self) -> list[str]:
        """The ids of the clips."""
        return [str(clip_id) for clip_id in self.labels.ids[self.numbers]]


@dataclass(frozen=True, slots=True)
class Map:
    """The points of n clips, with what is known of the clips; see `Placed`."""

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
    """The map of the clips that pass a filter, see `place_clips`."""
    placed = place_clips(lib, space, dimensions, clip_filter, limit)
    ids = placed.ids
    with lib.store.read() as tx:
        records = clips.get_many(tx, ids)
    # A clip may have been deleted since the index caught up.
    rows = [row for row, clip_id in enumerate(ids) if clip_id in records]
    return Map(
        clips=tuple(records[ids[row]] for row in rows),
        points=placed.points[rows],
        kept=placed.kept,
        total=placed.total,
        library_version=placed.library_version,
        model=placed.model,
    )


def place_clips(
    lib: Library,
    space: str = "symbols",
    dimensions: int = 2,
    clip_filter: ClipFilter | None = None,
    limit: int = 10_000,
) -> Placed:
    """The points of the clips that pass a filter.

    dimensions: 2 or 3; limit: largest number of points. If more clips pass, the map shows `limit`
    of them, evenly spaced in the order of ids. Raises BadField, and ModelNotFitted for space
    "symbols" before the first fit.
    """
    if space not in SPACES:
        raise fields.bad_field("space", f"must be one of {', '.join(SPACES)}")
    if dimensions not in DIMENSIONS:
        raise fields.bad_field("dimensions", "must be 2 or 3")
    if not 1 <= limit <= MAX_POINTS:
        raise fields.bad_field("limit", f"must be from 1 to {MAX_POINTS}")
    lib.index.catch_up(lib.store)
    version, rows = lib.index.state
    labels = rows.labels
    matching = np.flatnonzero(labels.mask(resolved_filter(lib, clip_filter)))
    # By id, and not by row: then the same clips are selected after the index was built again.
    by_id = matching[np.argsort(labels.ids[matching].astype(str), kind="stable")]
    selected = by_id[_evenly(len(by_id), limit)]
    numbers, points, axes, model = _space_points(lib, space, rows, selected, dimensions)
    shown = axes.project(points) if len(numbers) else np.zeros((0, dimensions))
    return Placed(
        labels=labels,
        numbers=numbers,
        points=_padded(shown, dimensions),
        kept=_variance_share(points - axes.center, shown) if len(numbers) else 0.0,
        total=len(matching),
        library_version=version,
        model=model,
    )


def _space_points(
    lib: Library, space: str, rows: RowsView, selected: IntArray, dimensions: int
) -> tuple[IntArray, FloatArray, PrincipalAxes, str | None]:
    """The points of the selected clips that have one.

    Returns the clips' numbers (n,), points (n, d), the axes of the map, and the id of the model
    (None for vectors).
    """
    if space == "symbols":
        fitted = lib.models.words(lib.store)
        axes = principal_axes(fitted.model.space.points, dimensions)
        model_rows = clip_points(lib, fitted, rows.labels)
        placed = selected[model_rows.has_row[selected]]
        return placed, model_rows.values[placed], axes, fitted.id
    points = rows.vectors(selected).astype(np.float64)
    if not len(selected):
        return selected, points, PrincipalAxes(np.zeros(0), np.zeros((0, 0))), None
    return selected, points, principal_axes(points, dimensions), None


def _evenly(count: int, limit: int) -> IntArray:
    """At most `limit` indexes of `count`, evenly spaced."""
    return np.linspace(0, count - 1, min(count, limit)).round().astype(np.int64)


def _variance_share(centered: FloatArray, shown: FloatArray) -> float:
    """The share 0..1 of the variance of points (n, d) that their projections (n, 2 or 3) keep."""
    whole = float(np.square(centered).sum())
    return float(np.square(shown).sum()) / whole if whole > 0 else 1.0


def _padded(points: FloatArray, dimensions: int) -> FloatArray:
    """The points with zeros for missing dimensions: two clips span only one dimension."""
    return np.pad(points, ((0, 0), (0, dimensions - points.shape[1])))
