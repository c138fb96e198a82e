"""The motion shape: a clip as one vector from which a motion can be made again.

Like the motion sample it holds 32 moments, over the mean gait cycle where there are cycles,
else over the whole clip. Of each moment it has all that a motion is made of: the 13 joint
roles in the body frame, the height of the hips over the floor, their velocity and the yaw
rate; and besides how long it lasts and whether it goes round. Persons and tasks are parted in
this space to synthesize motions (Vasilescu 2002, section 4; models.synthesis).
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

CHANNELS = 13 * 3 + 4
"""Of a moment: positions (39, body lengths), height (1, body lengths), velocity to the left and
forward (2, body lengths / s), yaw rate (1, rad / s)."""

SHAPE_LENGTH = SAMPLES * CHANNELS + 2
"""Numbers in a motion shape: 1378."""

FLOOR_QUANTILE = 0.01
"""The floor is the level that the lowest joint goes under in this share of frames."""

_LOG_SECONDS = (-3.0, 6.0)
_OTHER_SIDE = [SUN_ROLES.index(role.mirrored()) for role in SUN_ROLES]


@dataclass(frozen=True, slots=True)
class Shape:
    """A motion shape taken apart; 32 moments.

    poses: (32, 13, 3) body lengths, body frame; heights: (32,) body lengths, of the hips over
    the floor; velocities: (32, 2) body lengths / s, to the left and forward; yaw_rates: (32,)
    rad / s; seconds: of the cycle, or of the whole; is_cyclic: whether the last moment is
    followed by the first.
    """

    poses: FloatArray
    heights: FloatArray
    velocities: FloatArray
    yaw_rates: FloatArray
    seconds: float
    is_cyclic: bool


def motion_shape(track: BodyTrack, cycles: list[tuple[float, float]] | None = None) -> FloatArray:
    """(1378,) float32: 32 x 43 channels, log seconds, 1.0 where cyclic and 0.0 where not.

    cycles: `exact_gait_cycles(track)`, where the caller has them.
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
    """(n, 43) the channels of every frame."""
    lowest = track.positions[:, :, 1].min(axis=1)
    floor = np.quantile(lowest, FLOOR_QUANTILE)
    return np.column_stack(
        [
            track.local.reshape(track.frames, -1),
            (track.origin[:, 1] - floor) / track.body_length,
            track.velocity()[:, [0, 2]],
            track.yaw_rate(),
        ]
    )


def mirrored(shapes: FloatArray) -> FloatArray:
    """(n, 1378) the same motions by bodies whose left and right are changed.

    A cycle starts at the left foot's swing: what is mirrored starts half a cycle later.
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
    """(...,) of moments (..., 43): how high the lowest joint is over the floor, body lengths."""
    poses = moments[..., :39].reshape(*moments.shape[:-1], 13, 3)
    return np.asarray(moments[..., 39] + poses[..., 1].min(axis=-1))


def closed(cycle: FloatArray) -> FloatArray:
    """(32, ...) of a cycle (33, ...) whose end is not quite its start: the difference is spread
    over the whole cycle, so that no jump is left where it goes round."""
    drift = cycle[-1] - cycle[0]
    phase = np.arange(SAMPLES) / SAMPLES - 0.5
    return np.asarray(cycle[:-1] - phase.reshape(-1, *(1,) * drift.ndim) * drift)


def parts_of(shape: FloatArray) -> Shape:
    """A motion shape (1378,) taken apart."""
    moments = np.asarray(shape[:-2], dtype=np.float64).reshape(SAMPLES, CHANNELS)
    return Shape(
        poses=moments[:, :39].reshape(SAMPLES, 13, 3),
        heights=moments[:, 39],
        velocities=moments[:, 40:42],
        yaw_rates=moments[:, 42],
        seconds=float(np.exp(np.clip(shape[-2], *_LOG_SECONDS))),
        is_cyclic=bool(shape[-1] >= 0.5),
    )
