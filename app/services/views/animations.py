"""A ready clip as an animated picture: the whole motion, or reduced to few dimensions."""

from __future__ import annotations

import math

import numpy as np

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.figures.animated_figure import animated_svg
from app.services.figures.camera import Figure
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.views.low_dimensional import Reduction, reduce
from app.store.clips import arrays

ROLE_NAMES = tuple(role.value for role in SUN_ROLES)


def role_figure(positions: FloatArray, label: str = "") -> Figure:
    """A figure to draw from positions (frames, 13, 3) in SUN_ROLES order."""
    return Figure(positions, np.array(SUN_PARENTS), ROLE_NAMES, label)


def animation_svg(
    lib: Library,
    clip_id: str,
    reduction: Reduction | None = None,
    start: float | None = None,
    end: float | None = None,
) -> str:
    """A clip, or its part from `start` to `end` seconds, as an animated SVG.

    Raises BadField, ClipNotFound, ClipNotReady, NotEnoughKeyposes.
    """
    clip = ready_clip(lib, clip_id)
    if reduction is not None:
        positions = reduce(lib, clip, reduction).reduced.positions
    else:
        with lib.store.read() as tx:
            positions = arrays.get_one(tx, clip_id, "role_positions")
    return animated_svg([role_figure(_part(positions, start, end))], ANALYSIS_RATE, clip.name)


def _part(positions: FloatArray, start: float | None, end: float | None) -> FloatArray:
    duration = len(positions) / ANALYSIS_RATE
    for name, value in (("start", start), ("end", end)):
        if value is not None and not (math.isfinite(value) and value >= 0):
            raise fields.bad_field(name, "must be a number of seconds, zero or more")
    if start is not None and start >= duration:
        raise fields.bad_field("start", f"must be below the duration, {duration:.3f} s")
    if start is not None and end is not None and end <= start:
        raise fields.bad_field("end", "must be after start")
    # Whole frames that contain the part, at least one.
    first = math.floor((start or 0.0) * ANALYSIS_RATE)
    stop = len(positions) if end is None else math.ceil(end * ANALYSIS_RATE)
    return positions[first : max(stop, first + 1)]
