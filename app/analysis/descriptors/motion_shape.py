"""The motion shape: a clip as one vector from which a motion can be reconstructed.

Like the motion sample, it holds 32 moments of the mean gait cycle if there are gait cycles, else
of the whole clip. Each moment has the 13 joint roles in the body frame, the height of the hips
above the floor, their velocity and the yaw rate. Two more numbers are the duration and whether the
motion is cyclic. Synthesis separates persons and tasks in this space (Vasilescu 2002, section 4;
app.models.synthesis).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.analysis.descriptors.motion_sample import SAMPLES, mean_over_cycles
from app.motion.frame.body_frame import BodyTrack
from app.motion.frame.gait import exact_gait_cycles
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.resampling import resample_to
from app.numerics.arrays import FloatArray
from app.numerics.quantiles import quantile

CHANNELS = 13 * 3 + 4
"""Numbers of a moment, 43: positions (39, body lengths), height (1, body lengths), velocity to
the left and forward (2, body lengths / s), yaw rate (1, rad / s)."""

SHAPE_LENGTH = SAMPLES * CHANNELS + 2
"""The length of a motion shape: 1378."""

FLOOR_QUANTILE = 0.01
"""The lowest joint is below the floor in this share of the frames."""

_LOG_SECONDS = (-3.0, 6.0)
_OTHER_SIDE = [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]


@dataclass(frozen=True, slots=True)
class Shape:
    """The parts of a motion shape, with 32 moments.

    poses: (32, 13, 3) in the body frame, body lengths. heights: (32,) of the hips above the
    floor, body lengths. velocities: (32, 2) to the left and forward, body lengths / s.
    yaw_rates: (32,) rad / s. seconds: the duration of the cycle, or of the whole motion.
    is_cyclic: whether the first moment follows the last one.
    """

    poses: FloatArray
    heights: FloatArray
    velocities: FloatArray
    yaw_rates: FloatArray
    seconds: float
    is_cyclic: bool


def motion_shape(track: BodyTrack, cycles: list[tuple[float, float]] | None = None) -> FloatArray:
    """(1378,) float32: 32 x 43 channels, the log of the seconds, and 1 if cyclic, else 0.

    cycles: `exact_gait_cycles(track)`, if the caller has them.
    """
    moments = moments_of(track)
    cycles = exact_gait_cycles(track) if cycles is None else cycles
    if cycles:
        shaped = closed(mean_over_cycles(moments, cycles))
        frames = float(np.mean([end - start for start, end in cycles]))
    else:
        shaped, frames = resample_to(moments, SAMPLES), float(track.frames)
    end = [np.log(frames / track.rate), float(bool(cycles))]
    return np.concatenate([shaped.ravel(), end]).astype(np.float32)


def moments_of(track: BodyTrack) -> FloatArray:
    """(n, 43) the CHANNELS of each frame of `track`."""
    lowest = track.positions[:, :, 1].min(axis=1)
    floor = quantile(lowest, FLOOR_QUANTILE)
    return np.column_stack(
        [
            track.local.reshape(track.frames, -1),
            (track.origin[:, 1] - floor) / track.body_length,
            track.velocity()[:, [0, 2]],
            track.yaw_rate(),
        ]
    )


def mirrored(shapes: FloatArray) -> FloatArray:
    """(n, 1378) the motion shapes `shapes` (n, 1378) with left and right exchanged.

    A cycle starts at the swing of the left foot, so a mirrored cycle is shifted by half a cycle.
    """
    moments = shapes[:, :-2].reshape(-1, SAMPLES, CHANNELS)
    turned = np.empty_like(moments)
    poses = moments[:, :, :39].reshape(-1, SAMPLES, 13, 3)[:, :, _OTHER_SIDE]
    turned[:, :, :39] = (poses * [-1.0, 1.0, 1.0]).reshape(-1, SAMPLES, 39)
    turned[:, :, 39:] = moments[:, :, 39:] * [1.0, -1.0, 1.0, -1.0]
    is_cyclic = shapes[:, -1] >= 0.5
    turned[is_cyclic] = np.roll(turned[is_cyclic], SAMPLES // 2, axis=1)
    return np.hstack([turned.reshape(len(shapes), -1), shapes[:, -2:]])


def clearance(moments: FloatArray) -> FloatArray:
    """(...,) the height of the lowest joint above the floor, body lengths; moments: (..., 43)."""
    poses = moments[..., :39].reshape(*moments.shape[:-1], 13, 3)
    return np.asarray(moments[..., 39] + poses[..., 1].min(axis=-1))


def closed(cycle: FloatArray) -> FloatArray:
    """(32, ...) a cycle (33, ...) changed so that its end meets its start.

    Their difference is distributed over the whole cycle, so that no jump is left.
    """
    drift = cycle[-1] - cycle[0]
    phase = np.arange(SAMPLES) / SAMPLES - 0.5
    return np.asarray(cycle[:-1] - phase.reshape(-1, *(1,) * drift.ndim) * drift)


def parts_of(shape: FloatArray) -> Shape:
    """The parts of a motion shape (1378,)."""
    moments = np.asarray(shape[:-2], dtype=np.float64).reshape(SAMPLES, CHANNELS)
    return Shape(
        poses=moments[:, :39].reshape(SAMPLES, 13, 3),
        heights=moments[:, 39],
        velocities=moments[:, 40:42],
        yaw_rates=moments[:, 42],
        seconds=float(np.exp(np.clip(shape[-2], *_LOG_SECONDS))),
        is_cyclic=bool(shape[-1] >= 0.5),
    )
