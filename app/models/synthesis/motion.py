"""From a motion shape to a body that moves in the world.

A cycle is repeated. Other motions have more detail than 32 moments can hold (a waving hand). For
them, a real take of the task is the base: a slow correction brings it to the shape and to the
timing of the shape, so that its quick movements remain. The path over ground is such that standing
feet do not slide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.analysis.descriptors.motion_sample import SAMPLES
from app.analysis.descriptors.motion_shape import CHANNELS, Shape, clearance, parts_of
from app.models.synthesis.timing import warp_to_references
from app.motion.frame.body_frame import ANALYSIS_RATE, turned
from app.motion.frame.foot_contact import FEET, carried_by_feet
from app.motion.roles.joint_roles import SUN_ROLES
from app.motion.skeleton.resampling import resample_to, sample_at
from app.numerics.arrays import FloatArray

USUAL_SECONDS = 4.0
"""Default duration: a cycle is repeated to about this length."""

CORRECTION_SMOOTHING = 1.0
"""Standard deviation, in moments (of 32), of the smoothing of the correction of a take. Without it,
the motions of the bench have more than twice the jerk; at 2.5 they lose half their hits."""

TIME_SMOOTHING = 2.0
"""Standard deviation, in moments (of 32), of the smoothing of the timing of a take. Without it, the
motions of the bench have a quarter more jerk, and no more hits."""

MIN_SECONDS = 0.2


@dataclass(frozen=True, slots=True)
class Course:
    """A moving body at ANALYSIS_RATE.

    positions: (n, 13, 3) meters, Y up, in SUN_ROLES order; heading: (n,) radians about Y;
    cycles: number of cycles, 0 for a motion that is not cyclic.
    """

    positions: FloatArray
    heading: FloatArray
    cycles: int


def course_of(
    shape: FloatArray,
    body_length: float,
    *,
    seconds: float | None = None,
    take: FloatArray | None = None,
    take_shape: FloatArray | None = None,
) -> Course:
    """The motion of a shape (1378,) by a body of `body_length` meters.

    seconds: the requested duration; a cycle is repeated to about this length, any other motion
    is stretched to it; None: the duration of the shape (cycles: USUAL_SECONDS). take: (n, 43)
    moments of a real take that is not cyclic, and take_shape (1378,) its shape, for the detail.
    """
    split = parts_of(shape)
    if split.is_cyclic:
        moments, cycles = _repeated(shape, split, seconds)
    else:
        moments, cycles = _stretched(shape, seconds or split.seconds, take, take_shape), 0
    return _in_the_world(moments, body_length, cycles)


def _repeated(shape: FloatArray, split: Shape, seconds: float | None) -> tuple[FloatArray, int]:
    """(n, 43) whole cycles of equal length; the end meets the start."""
    frames = max(round(split.seconds * ANALYSIS_RATE), 4)
    wished = USUAL_SECONDS if seconds is None else seconds
    cycles = max(round(wished * ANALYSIS_RATE / frames), 1)
    around = _moments(shape)
    padded = np.concatenate([around[-2:], around, around[:3]])
    once = sample_at(padded, 2 + SAMPLES * np.arange(frames) / frames)
    return np.tile(once, (cycles, 1)), cycles


def _stretched(
    shape: FloatArray, seconds: float, take: FloatArray | None, take_shape: FloatArray | None
) -> FloatArray:
    frames = max(round(max(seconds, MIN_SECONDS) * ANALYSIS_RATE), 2)
    wanted = _moments(shape)
    if take is None or take_shape is None:
        return resample_to(wanted, frames)
    own = np.asarray(take_shape, dtype=np.float64)
    timed = warp_to_references(own[None], np.asarray(shape)[None], TIME_SMOOTHING)
    there = _moments(timed.shapes[0])
    slow = scipy.ndimage.gaussian_filter1d(
        wanted - there, CORRECTION_SMOOTHING, axis=0, mode="nearest"
    )
    detailed = _in_time(take, timed.timing[0], frames)
    made = detailed + resample_to(slow, frames)
    # The height is that of the take plus the change of the shape: a sum of poses has another.
    higher = clearance(wanted) - clearance(there)
    higher = scipy.ndimage.gaussian_filter1d(higher, CORRECTION_SMOOTHING, mode="nearest")[:, None]
    made[:, 39] += clearance(detailed) + resample_to(higher, frames)[:, 0] - clearance(made)
    return np.asarray(made)


def _in_time(take: FloatArray, timing: FloatArray, frames: int) -> FloatArray:
    """(frames, 43) the moments of a take (n, 43), delayed by `timing` (32,) moments."""
    steady = resample_to(take, frames)
    late = np.interp(np.linspace(0, SAMPLES - 1, frames), np.arange(SAMPLES), timing)
    return sample_at(steady, np.arange(frames) + late * (frames - 1) / (SAMPLES - 1))


def _moments(shape: FloatArray) -> FloatArray:
    return np.asarray(shape[:-2], dtype=np.float64).reshape(SAMPLES, CHANNELS)


def _in_the_world(moments: FloatArray, body_length: float, cycles: int) -> Course:
    """Moments (n, 43) integrated to a way over ground, then carried by the standing feet."""
    step = 1 / ANALYSIS_RATE
    heading = np.concatenate([[0.0], np.cumsum(moments[:-1, 42]) * step])
    velocity = np.zeros((len(moments), 1, 3))
    velocity[:, 0, 0], velocity[:, 0, 2] = moments[:, 40], moments[:, 41]
    way = turned(velocity * body_length, heading)[:, 0] * step
    origin = np.concatenate([np.zeros((1, 3)), np.cumsum(way[:-1], axis=0)])
    origin[:, 1] = moments[:, 39] * body_length
    local = moments[:, :39].reshape(-1, len(SUN_ROLES), 3) * body_length
    around = turned(local, heading)
    feet = (around + origin[:, None])[:, FEET]
    origin = carried_by_feet(origin, feet, ANALYSIS_RATE)
    return Course(around + origin[:, None], heading, cycles)
