"""Views of a ready clip: its motion, its descriptors, and a small picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.motion.roles.joint_roles import SUN_PARENTS, SUN_ROLES
from app.motion.skeleton.resampling import resample
from app.numerics.arrays import FloatArray
from app.services import fields
from app.services.figures.thumbnail import thumbnail
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.services.views.frame_rates import requested_rate
from app.store.clips import arrays

CONVERGENCE = "msv_convergence"


@dataclass(frozen=True, slots=True)
class MotionView:
    """A motion to draw.

    frame_rate: Hz; parents: (joints,) index of each joint's parent, -1 for a root; positions:
    (frames, joints, 3) float32, meters, Y up.
    """

    frame_rate: float
    joint_names: tuple[str, ...]
    parents: tuple[int, ...]
    positions: FloatArray


@dataclass(frozen=True, slots=True)
class DescriptorView:
    """A clip's descriptors.

    msv_lambda: weight; msv_rho: (13,); msv_epsilon: (n,); msv_convergence: (iterations, 2)
    error and change of lambda, None if the analysis is older than their storage;
    motion_vector: (128,); symbol_states: K; symbol_means, symbol_variances: (K, 26);
    analysis_version: of all of them.
    """

    msv_lambda: float
    msv_rho: FloatArray
    msv_epsilon: FloatArray
    msv_convergence: FloatArray | None
    motion_vector: FloatArray
    symbol_states: int
    symbol_means: FloatArray
    symbol_variances: FloatArray
    analysis_version: int


def motion(lib: Library, clip_id: str, fps: float | None = None, joints: str = "all") -> MotionView:
    """A clip's motion, resampled by time to `fps` (default: its own rate).

    joints: "all", or "roles" for the 13 joint roles. Raises BadField, ClipNotFound, ClipNotReady.
    """
    if joints not in ("all", "roles"):
        raise fields.bad_field("joints", "must be all or roles")
    clip = ready_clip(lib, clip_id)
    count = len(SUN_ROLES) if joints == "roles" else clip.joints or 0
    rate = requested_rate(lib, clip, fps, source=clip.frame_rate or 1.0, joints=count)
    stored = load_motion(lib, clip)
    names, parents, positions = stored.names, tuple(stored.parents.tolist()), stored.positions
    if joints == "roles":
        names, parents = tuple(role.value for role in SUN_ROLES), SUN_PARENTS
        positions = stored.role_positions()
    if rate != stored.frame_rate:
        positions = resample(positions, stored.frame_rate, rate)
    positions = np.ascontiguousarray(positions, dtype=np.float32)
    return MotionView(rate, names, parents, positions)


def descriptor(lib: Library, clip_id: str) -> DescriptorView:
    """A clip's descriptors. Raises ClipNotFound, ClipNotReady."""
    clip = ready_clip(lib, clip_id)
    names = (
        "msv_lambda",
        "msv_rho",
        "msv_epsilon",
        "motion_vector",
        "symbol_means",
        "symbol_variances",
    )
    found: dict[str, NDArray[Any]] = {}
    with lib.store.read() as tx:
        for name in names:
            found[name] = arrays.get_one(tx, clip_id, name)
        convergence = arrays.get_many(tx, [clip_id], CONVERGENCE).get(clip_id)
    return DescriptorView(
        msv_lambda=float(found["msv_lambda"][0]),
        msv_rho=found["msv_rho"],
        msv_epsilon=found["msv_epsilon"],
        msv_convergence=convergence,
        motion_vector=found["motion_vector"],
        symbol_states=len(found["symbol_means"]),
        symbol_means=found["symbol_means"],
        symbol_variances=found["symbol_variances"],
        analysis_version=clip.analysis_version or 0,
    )


def thumbnail_svg(lib: Library, clip_id: str) -> str:
    """A clip as an SVG of a few stick figures. Raises ClipNotFound, ClipNotReady."""
    clip = ready_clip(lib, clip_id)
    with lib.store.read() as tx:
        positions = arrays.get_one(tx, clip_id, "role_positions")
    return thumbnail(positions, clip.name)
