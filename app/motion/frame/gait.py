"""Gait cycles (DESIGN 4): from one forward swing of the left foot to its next.

The fore-aft difference of the feet in the body frame, cut at its upward zero crossings.
A motion is cyclic where such cycles follow one another, last as human steps do and swing
widely to both sides; anything else has none.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

SMOOTHING = 0.05
"""Seconds (standard deviation)."""

MIN_CYCLE = 0.4
MAX_CYCLE = 2.0
"""Seconds for both steps, from a sprint to a stroll."""

MIN_SWING = 0.15
"""Body lengths that the feet must part, to each side, in a cycle."""

MIN_TRAVEL = 0.3
"""Body lengths that the hips must travel in a cycle: kicks and dances on the spot do not."""

LACKING = 0.15
"""Share of a cycle that a short clip may lack."""

LEFT_FOOT = SUN_ROLES.index(JointRole.LEFT_FOOT)
RIGHT_FOOT = SUN_ROLES.index(JointRole.RIGHT_FOOT)
FORWARD = 2


def gait_cycles(track: BodyTrack) -> list[tuple[int, int]]:
    """(first, stop) frames of each gait cycle of `track`, in order; empty where none."""
    return _cycles(track, foot_split(track))


def exact_gait_cycles(track: BodyTrack) -> list[tuple[float, float]]:
    """(start, end) of each gait cycle of `track` in frames, between frames too.

    A cycle cut at whole frames would be out of phase by as much as the stride of one.
    """
    split = foot_split(track)
    cycles = _cycles(track, split)
    return [(_crossing(split, first), _crossing(split, stop)) for first, stop in cycles]


def _cycles(track: BodyTrack, split: FloatArray) -> list[tuple[int, int]]:
    cuts = list(pairwise(_upward(split))) or _lone_cycle(split)
    return [cut for cut in cuts if _is_stride(track, split, *cut)]


def _upward(split: FloatArray) -> list[int]:
    """Frames at which (n,) `split` has just become positive."""
    return [int(frame) + 1 for frame in np.flatnonzero((split[:-1] <= 0) & (split[1:] > 0))]


def _crossing(split: FloatArray, frame: int) -> float:
    """When `split` (n,) rises through zero just before `frame`, in frames."""
    if not 0 < frame < len(split) or not split[frame - 1] <= 0 < split[frame]:
        return float(frame)
    return float(frame - split[frame] / (split[frame] - split[frame - 1]))


def _lone_cycle(split: FloatArray) -> list[tuple[int, int]]:
    """The cycle of a clip too short for two upward crossings, timed by the downward ones.

    It starts or ends at the upward crossing; up to LACKING of it may be cut off.
    """
    upward, downward = _upward(split), _upward(-split)
    if len(upward) != 1 or len(downward) != 2:
        return []
    middle, length = upward[0], downward[1] - downward[0]
    for first, stop in ((middle, middle + length), (middle - length, middle)):
        held = max(first, 0), min(stop, len(split))
        if held[1] - held[0] >= (1 - LACKING) * length:
            return [held]
    return []


def foot_split(track: BodyTrack) -> FloatArray:
    """(n,) how far the left foot is before the right one, body lengths, smoothed."""
    split = track.local[:, LEFT_FOOT, FORWARD] - track.local[:, RIGHT_FOOT, FORWARD]
    return np.asarray(
        scipy.ndimage.gaussian_filter1d(split, SMOOTHING * track.rate, mode="nearest")
    )


def _is_stride(track: BodyTrack, split: FloatArray, first: int, stop: int) -> bool:
    """Whether frames first..stop-1 last, swing and travel as two steps do."""
    within = split[first:stop]
    seconds = (stop - first) / track.rate
    if not MIN_CYCLE <= seconds <= MAX_CYCLE:
        return False
    last = min(stop, track.frames - 1)
    travel = np.linalg.norm((track.origin[last] - track.origin[first])[[0, FORWARD]])
    parted = min(within.max(), -within.min()) >= MIN_SWING
    return bool(parted and travel / track.body_length >= MIN_TRAVEL)
