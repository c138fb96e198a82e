"""The feet and the floor: sliding, sinking, floating, flights and support.

Heights are those of the ankles: a foot that stands has its ankle above the floor. The floor is the
height at which the ankles rest most of the time that they hardly move, so neither the height of the
ankles nor a shifted origin matters. Stairs and slopes are not known: they look like faults.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.canonical.center_of_mass import center_of_mass
from app.motion.frame.body_frame import BodyTrack
from app.motion.frame.foot_contact import FEET, MIN_STANCE
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import BoolArray, FloatArray

TOLERANCE = 0.02
"""Meters by which an ankle may leave its floor before it counts."""

LOW = 0.035
"""Meters above its floor up to which an ankle counts as on it."""

CALMEST = 0.1
"""Quantile of the speeds in a stance that counts as its calmest."""

RESTING_SPEED = 0.25
"""Meters per second. A slower ankle near its lowest height rests."""

LOWEST, REACH = 0.05, 0.15
"""Quantile of the heights of an ankle that counts as lowest, and meters above it within which the
floor is looked for."""

BIN = 0.005
"""Meters: the width of a bin of the histogram of heights."""

MIN_RESTS = 5
"""Frames of resting ankles that tell the floor."""

HIGH = 0.1
"""Body lengths above its floor from which an ankle is high, as in `movement_signs.IN_AIR`."""

FALL = -9.81 / 2
"""Meters per second squared: a body in free flight accelerates downward by more than this."""

FALL_SMOOTHING = 1.5
"""Frames (standard deviation) by which the center of mass is smoothed before it is differentiated:
few enough for flights of .15 s."""

BESIDE = 0.35
"""Body lengths between the center of mass and its support from which a body must fall."""


@dataclass(frozen=True, slots=True)
class FloorMeasures:
    """See `definitions`: the members have the names of the measures."""

    foot_skate: float
    ground_penetration: float
    floating: float
    airborne_time: float
    unsupported_time: float


def floor_measures(track: BodyTrack) -> FloorMeasures:
    """The measures of a smoothed track."""
    feet = track.positions[:, FEET]
    floor = floor_of(feet, track.rate)
    above = feet[:, :, 1] - floor
    lower = above.min(axis=1)
    flies = _in_flight(track, lower)
    near = _near_floor(track, floor)
    rests_elsewhere = near[:, len(FEET) :].any(axis=1)
    hovers = np.where(flies | rests_elsewhere, 0.0, np.maximum(lower - TOLERANCE, 0.0))
    falls_over = ~flies & (_beside(track, near) > BESIDE * track.body_length)
    return FloorMeasures(
        foot_skate=_skate(feet, above, track.rate),
        ground_penetration=float(np.maximum(-lower - TOLERANCE, 0.0).mean()),
        floating=float(hovers.mean()),
        airborne_time=float(flies.sum() / track.rate),
        unsupported_time=float(falls_over.sum() / track.rate),
    )


def floor_of(feet: FloatArray, rate: float) -> float:
    """The height at which `feet` (n, 2, 3) rest most, meters.

    It is the fullest bin, smoothed, of the heights of ankles that hardly move and are low. In a run
    they never rest: then it is the median of the heights at which the lower ankle turns upward.
    """
    speeds = np.linalg.norm(np.diff(feet, axis=0, prepend=feet[:1]), axis=-1) * rate
    heights = feet[:, :, 1]
    lower = heights.min(axis=1)
    lowest = float(np.sort(lower)[round(LOWEST * (len(lower) - 1))])
    rests = heights[(speeds < RESTING_SPEED) & (heights < lowest + REACH)]
    if len(rests) >= MIN_RESTS:
        return _mode(rests)
    inner = lower[1:-1]
    touches = inner[(inner <= lower[:-2]) & (inner < lower[2:]) & (inner < lowest + REACH)]
    return float(np.median(touches)) if len(touches) else lowest


def _mode(heights: FloatArray) -> float:
    """The height about which most of `heights` (n,) lie."""
    low = float(heights.min())
    counts = np.bincount(((heights - low) / BIN).astype(np.int64), minlength=3).astype(np.float64)
    dense = scipy.ndimage.gaussian_filter1d(counts, 1.5, mode="constant")
    return low + (int(np.argmax(dense)) + 0.5) * BIN


def _skate(feet: FloatArray, above: FloatArray, rate: float) -> float:
    """The median over stances of the speed at which the foot slides even in its calmest moment.

    The mean speed of feet on the floor would be as large in runs, whose ankles roll over toes that
    stand, as in sliding clips.
    """
    speeds = np.linalg.norm(np.gradient(feet[:, :, [0, 2]], axis=0), axis=-1) * rate
    found = []
    for foot in range(feet.shape[1]):
        edges = np.flatnonzero(np.diff((above[:, foot] < LOW).astype(int), prepend=0, append=0))
        for first, stop in edges.reshape(-1, 2):
            if (stop - first) / rate >= MIN_STANCE:
                stance = np.sort(speeds[first:stop, foot])
                found.append(float(stance[round(CALMEST * (len(stance) - 1))]))
    return float(np.median(found)) if found else 0.0


def _in_flight(track: BodyTrack, lower: FloatArray) -> BoolArray:
    """(n,) whether both ankles are high and the body falls freely."""
    height = center_of_mass(track.positions)[:, 1]
    smooth = scipy.ndimage.gaussian_filter1d(height, FALL_SMOOTHING, mode="nearest")
    falls = np.gradient(np.gradient(smooth)) * track.rate**2 < FALL
    return np.asarray(falls & (lower > HIGH * track.body_length))


_OTHERS = [
    SUN_ROLES.index(role)
    for role in (
        *(JointRole.HIPS, JointRole.LEFT_KNEE, JointRole.RIGHT_KNEE),
        *(JointRole.LEFT_HAND, JointRole.RIGHT_HAND, JointRole.HEAD),
    )
]
_CARRYING = [*FEET, *_OTHERS]
"""The joints that may carry a body: those of the feet, and others."""


def _near_floor(track: BodyTrack, floor: float) -> BoolArray:
    """(n, 8) whether each of _CARRYING is near the floor, so that it may carry the body."""
    return np.asarray(track.positions[:, _CARRYING, 1] < floor + HIGH * track.body_length)


def _beside(track: BodyTrack, near: BoolArray) -> FloatArray:
    """(n,) meters over the floor from the center of mass to the line between any two joints near
    the floor; infinite without any."""
    center = center_of_mass(track.positions)[:, [0, 2]]
    flat = track.positions[:, _CARRYING][..., [0, 2]] - center[:, None]
    best = np.full(track.frames, np.inf)
    used = np.flatnonzero(near.any(axis=0))
    for place, one in enumerate(used):
        for other in used[place:]:
            both = near[:, one] & near[:, other]
            start, line = flat[both, one], flat[both, other] - flat[both, one]
            along = -(start * line).sum(axis=1) / np.maximum((line**2).sum(axis=1), 1e-12)
            away = np.linalg.norm(start + np.clip(along, 0.0, 1.0)[:, None] * line, axis=1)
            best[both] = np.minimum(best[both], away)
    return best
