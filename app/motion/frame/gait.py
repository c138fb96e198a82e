"""Gait cycles: from one forward swing of the left foot to the next.

A cycle starts where the left foot passes the right one forward. This is an upward zero crossing of
the difference of the feet along the forward axis of the body frame. A cycle must have the duration
of two human steps, swing widely to both sides, and travel. Other motions have no cycles.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

SMOOTHING = 0.05
"""Seconds: the standard deviation of the filter of the foot difference."""

MIN_CYCLE = 0.4
MAX_CYCLE = 2.0
"""Seconds for both steps: from a sprint to a slow walk."""

MIN_SWING = 0.15
"""Body lengths by which each foot must be ahead of the other one in a cycle."""

MIN_TRAVEL = 0.3
"""Body lengths that the hips must travel in a cycle. Kicks and dances on the spot do not."""

MAX_MISSING_SHARE = 0.15
"""The share of a cycle that may be missing in a short clip."""

LEFT_FOOT = SUN_ROLES.index(JointRole.LEFT_FOOT)
RIGHT_FOOT = SUN_ROLES.index(JointRole.RIGHT_FOOT)
FORWARD = 2


def gait_cycles(track: BodyTrack) -> list[tuple[int, int]]:
    """The first frame and the stop of each gait cycle of `track`, in order; may be empty."""
    return _cycles(track, foot_split(track))


def exact_gait_cycles(track: BodyTrack) -> list[tuple[float, float]]:
    """The start and the end of each gait cycle of `track`, in frames and fractions of frames.

    If cycles were cut at whole frames, their phases would be wrong by up to a frame.
    """
    split = foot_split(track)
    cycles = _cycles(track, split)
    return [(_crossing(split, first), _crossing(split, stop)) for first, stop in cycles]


def _cycles(track: BodyTrack, split: FloatArray) -> list[tuple[int, int]]:
    cuts = list(pairwise(_upward(split))) or _lone_cycle(split)
    return [cut for cut in cuts if _is_stride(track, split, *cut)]


def _upward(split: FloatArray) -> list[int]:
    """The first frame of each positive part of `split` (n,)."""
    return [int(frame) + 1 for frame in np.flatnonzero((split[:-1] <= 0) & (split[1:] > 0))]


def _crossing(split: FloatArray, frame: int) -> float:
    """The time, in frames, at which `split` (n,) crosses zero upward just before `frame`.

    This is `frame` if there is no crossing, as at the ends of a short clip.
    """
    if not 0 < frame < len(split) or not split[frame - 1] <= 0 < split[frame]:
        return float(frame)
    return float(frame - split[frame] / (split[frame] - split[frame - 1]))


def _lone_cycle(split: FloatArray) -> list[tuple[int, int]]:
    """The cycle of a clip that is too short for two upward crossings; empty if there is none.

    The two downward crossings give its length. It starts or ends at the upward crossing. A share
    of MAX_MISSING_SHARE may be missing.
    """
    upward, downward = _upward(split), _upward(-split)
    if len(upward) != 1 or len(downward) != 2:
        return []
    middle, length = upward[0], downward[1] - downward[0]
    for first, stop in ((middle, middle + length), (middle - length, middle)):
        present = max(first, 0), min(stop, len(split))
        if present[1] - present[0] >= (1 - MAX_MISSING_SHARE) * length:
            return [present]
    return []


def foot_split(track: BodyTrack) -> FloatArray:
    """(n,) the distance of the left foot ahead of the right one, in body lengths, smoothed."""
    split = track.local[:, LEFT_FOOT, FORWARD] - track.local[:, RIGHT_FOOT, FORWARD]
    return np.asarray(
        scipy.ndimage.gaussian_filter1d(split, SMOOTHING * track.rate, mode="nearest")
    )


def _is_stride(track: BodyTrack, split: FloatArray, first: int, stop: int) -> bool:
    """Whether the frames first .. stop - 1 have the duration, swing and travel of two steps."""
    within = split[first:stop]
    seconds = (stop - first) / track.rate
    if not MIN_CYCLE <= seconds <= MAX_CYCLE:
        return False
    last = min(stop, track.frames - 1)
    travel = np.linalg.norm((track.origin[last] - track.origin[first])[[0, FORWARD]])
    parted = min(within.max(), -within.min()) >= MIN_SWING
    return bool(parted and travel / track.body_length >= MIN_TRAVEL)
