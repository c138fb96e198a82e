"""Gait cycles: from one forward swing of the left foot to the next.

The fore-aft difference of the feet in the body frame is cut at its upward zero crossings. A cycle
must last as long as two human steps, swing widely to both sides, and travel. Other motions have no
cycles.
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
"""Seconds for both steps: from a sprint to a slow walk."""

MIN_SWING = 0.15
"""Body lengths by which each foot must be ahead of the other one in a cycle."""

MIN_TRAVEL = 0.3
"""Body lengths that the hips must travel in a cycle. Kicks and dances on the spot do not."""

LACKING = 0.15
"""The share of a cycle that may be missing in a short clip."""

LEFT_FOOT = SUN_ROLES.index(JointRole.LEFT_FOOT)
RIGHT_FOOT = SUN_ROLES.index(JointRole.RIGHT_FOOT)
FORWARD = 2


def gait_cycles(track: BodyTrack) -> list[tuple[int, int]]:
    """The first frame and the stop of each gait cycle of `track`, in order; may be empty."""
    return _cycles(track, foot_split(track))


def exact_gait_cycles(track: BodyTrack) -> list[tuple[float, float]]:
    """The start and the end of each gait cycle of `track`, in fractions of frames.

    If cycles were cut at whole frames, their phases would be wrong by up to a frame.
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
    """The cycle of a clip that is too short for two upward crossings.

    The downward crossings give its length. It starts or ends at the upward crossing; up to
    LACKING of it may be missing.
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
    """(n,) how far the left foot is ahead of the right one, in body lengths, smoothed."""
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
