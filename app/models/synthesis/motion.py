"""Converts a motion shape to a body that moves in the world.

A cycle is repeated. Other motions have more detail than 32 moments can store (a waving hand). So
they start from a real take of the task. A slow correction changes its poses and its timing to those
of the shape, and keeps its quick movements. The path over the ground is chosen so that standing
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
"""Default duration: a cycle is repeated until it has about this length."""

CORRECTION_SMOOTHING = 1.0
"""Standard deviation, in moments (of 32), of the smoothing of the correction of a take. Without it,
the motions of the bench have more than twice the jerk; at 2.5 they lose half their hits."""

TIME_SMOOTHING = 2.0
"""Standard deviation, in moments (of 32), of the smoothing of the timing of a take. Without it, the
motions of the bench have a quarter more jerk, and no more hits."""

CYCLE_SMOOTHING = 0.7
"""Standard deviation, in moments (of 32), of the smoothing of a cycle: a prediction adds up the
noise of many takes. Without it, 16 cycles of dataset 1 have 2.1 times the jerk of real takes
(median), with it 1.3 times, with as many hits and as little foot skate. 1.0 gives 0.9 times, and
one hit less."""

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

    seconds: the requested duration. A cycle is repeated until it has about this duration, any
    other motion is stretched to it. None is the duration of the shape, or USUAL_SECONDS for a
    cycle. take: (n, 43) moments of a real take that is not cyclic, for the detail. take_shape:
    (1378,) the shape of that take.
    """
    split = parts_of(shape)
    if split.is_cyclic:
        moments, cycles = _repeated(shape, split, seconds)
    else:
        moments, cycles = _stretched(shape, seconds or split.seconds, take, take_shape), 0
    return _in_the_world(moments, body_length, cycles)


def _repeated(shape: FloatArray, split: Shape, seconds: float | None) -> tuple[FloatArray, int]:
    """(n, 43) whole cycles of equal length, and their number; the end continues at the start."""
    frames = max(round(split.seconds * ANALYSIS_RATE), 4)
    requested = USUAL_SECONDS if seconds is None else seconds
    cycles = max(round(requested * ANALYSIS_RATE / frames), 1)
    moments = scipy.ndimage.gaussian_filter1d(_moments(shape), CYCLE_SMOOTHING, axis=0, mode="wrap")
    # moments of the neighboring cycles, so that the curve is smooth across the end
    padded = np.concatenate([moments[-2:], moments, moments[:3]])
    once = sample_at(padded, 2 + SAMPLES * np.arange(frames) / frames)
    return np.tile(once, (cycles, 1)), cycles


def _stretched(
    shape: FloatArray, seconds: float, take: FloatArray | None, take_shape: FloatArray | None
) -> FloatArray:
    frames = max(round(max(seconds, MIN_SECONDS) * ANALYSIS_RATE), 2)
    target = _moments(shape)
    if take is None or take_shape is None:
        return resample_to(target, frames)
    own = np.asarray(take_shape, dtype=np.float64)
    timed = warp_to_references(own[None], np.asarray(shape)[None], TIME_SMOOTHING)
    start = _moments(timed.shapes[0])
    slow = scipy.ndimage.gaussian_filter1d(
        target - start, CORRECTION_SMOOTHING, axis=0, mode="nearest"
    )
    detailed = _in_time(take, timed.timing[0], frames)
    corrected = detailed + resample_to(slow, frames)
    # The height above the floor is that of the take plus the change from its shape to the target.
    # The height of a sum of poses would be wrong.
    higher = clearance(target) - clearance(start)
    higher = scipy.ndimage.gaussian_filter1d(higher, CORRECTION_SMOOTHING, mode="nearest")[:, None]
    height = clearance(detailed) + resample_to(higher, frames)[:, 0]
    corrected[:, 39] += height - clearance(corrected)
    return np.asarray(corrected)


def _in_time(take: FloatArray, timing: FloatArray, frames: int) -> FloatArray:
    """(frames, 43) the moments of a take (n, 43), delayed by `timing` (32,) moments."""
    steady = resample_to(take, frames)
    delay = np.interp(np.linspace(0, SAMPLES - 1, frames), np.arange(SAMPLES), timing)
    return sample_at(steady, np.arange(frames) + delay * (frames - 1) / (SAMPLES - 1))


def _moments(shape: FloatArray) -> FloatArray:
    return np.asarray(shape[:-2], dtype=np.float64).reshape(SAMPLES, CHANNELS)


def _in_the_world(moments: FloatArray, body_length: float, cycles: int) -> Course:
    """The course of moments (n, 43).

    The velocities are integrated to a path over the ground. Then the path is corrected so that
    standing feet stay where they are.
    """
    step = 1 / ANALYSIS_RATE
    heading = np.concatenate([[0.0], np.cumsum(moments[:-1, 42]) * step])
    velocity = np.zeros((len(moments), 1, 3))
    velocity[:, 0, 0], velocity[:, 0, 2] = moments[:, 40], moments[:, 41]
    path = turned(velocity * body_length, heading)[:, 0] * step
    origin = np.concatenate([np.zeros((1, 3)), np.cumsum(path[:-1], axis=0)])
    origin[:, 1] = moments[:, 39] * body_length
    local = moments[:, :39].reshape(-1, len(SUN_ROLES), 3) * body_length
    body = turned(local, heading)
    feet = (body + origin[:, None])[:, FEET]
    origin = carried_by_feet(origin, feet, ANALYSIS_RATE)
    return Course(body + origin[:, None], heading, cycles)
