"""Numbers of each frame of a motion, from which the signs of movement of its parts are made.

Parts such as windows overlap, so it is cheaper to compute what a frame says once for all of them
(app.analysis.descriptors.movement_signs).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.motion.frame.body_frame import BodyTrack
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray, IntArray

_R = JointRole

SPEED_ROLES = (
    *(_R.LEFT_HAND, _R.RIGHT_HAND, _R.LEFT_ELBOW, _R.RIGHT_ELBOW),
    *(_R.LEFT_FOOT, _R.RIGHT_FOOT, _R.LEFT_KNEE, _R.RIGHT_KNEE, _R.HEAD),
)
"""The joints whose speeds are signs."""

MOVING = (*(f"{role.value}_speed" for role in SPEED_ROLES), "to_left", "forward")
"""The rows that are changes per second, in body lengths: the speed of each of SPEED_ROLES in the
body frame, and the velocity of the hips to the left and forward."""

RESTING = (
    *("heading", "lowest", "lower_foot", "hips"),
    *("higher_hand", "lower_hand", "left_foot", "right_foot", "higher_foot", "higher_knee"),
    *("lean", "lean_forward", "hands_apart", "feet_apart"),
)
"""The other rows. heading: radians. The next three are heights in the world, those of the second
line are in the body frame (hands: above the neck); all are in body lengths."""

ROWS = (*MOVING, *RESTING)

_SPEED_PLACES = [SUN_ROLES.index(role) for role in SPEED_ROLES]
_BODY = [place for place, role in enumerate(SUN_ROLES) if role is not _R.HIPS]
"""The joints of a pose. The hips are the origin of the body frame."""


@dataclass(frozen=True, slots=True)
class Parts:
    """w parts of a motion, n frames each.

    rows: (25, w, n) the ROWS. poses: (36, w, n) all joints in the body frame, without the hips.
    way: (w,) the distance on the floor from the first frame to the last, body lengths. rate: Hz.
    """

    rows: FloatArray
    poses: FloatArray
    way: FloatArray
    rate: float

    def __getitem__(self, name: str) -> FloatArray:
        """(w, n) the row of that name."""
        return np.asarray(self.rows[ROWS.index(name)])

    @property
    def duration(self) -> float:
        """Seconds of each part."""
        return float(self.rows.shape[2] / self.rate)


class SignSeries:
    """The numbers of each of the N >= 2 frames of a track.

    frames: N. rate: Hz.
    """

    def __init__(self, track: BodyTrack) -> None:
        self.frames, self.rate = track.frames, track.rate
        self._track = track
        self._cos, self._sin = np.cos(track.heading), np.sin(track.heading)
        self._poses = np.ascontiguousarray(track.local[:, _BODY].reshape(track.frames, -1).T)
        middle = np.arange(1, track.frames - 1)
        # the ends of MOVING stay zero: `of_parts` replaces them in each part
        self._rows = np.zeros((len(ROWS), track.frames))
        self._rows[: len(MOVING), 1:-1] = self._moving(middle - 1, middle + 1, middle, 2.0)
        self._rows[len(MOVING) :] = _resting(track)

    def of_parts(self, firsts: IntArray, frames: int) -> Parts:
        """The parts of `frames` frames, at least 2, that begin at `firsts` (w,).

        Differences in time are central, and one-sided at both ends of each part, as numpy's
        `gradient` makes them.
        """
        at, lasts = firsts[:, None] + np.arange(frames), firsts + frames - 1
        rows = self._rows[:, at]
        rows[: len(MOVING), :, 0] = self._moving(firsts, firsts + 1, firsts, 1.0)
        rows[: len(MOVING), :, -1] = self._moving(lasts - 1, lasts, lasts, 1.0)
        track = self._track
        moved = (track.origin[lasts] - track.origin[firsts]) / track.body_length
        return Parts(rows, self._poses[:, at], np.hypot(moved[:, 0], moved[:, 2]), track.rate)

    def _moving(self, start: IntArray, end: IntArray, at: IntArray, steps: float) -> FloatArray:
        """(11, k) MOVING at the frames `at` (k,), from the change from the frames `start` to the
        frames `end`, `steps` later."""
        track, per_second = self._track, self._track.rate / steps
        moved = (track.local[end] - track.local[start])[:, _SPEED_PLACES]
        speeds = np.sqrt(np.einsum("kjx,kjx->jk", moved, moved))
        x, _, z = (track.origin[end] - track.origin[start]).T / track.body_length
        cos, sin = self._cos[at], self._sin[at]  # into the body frame: about Y by -heading
        return np.vstack([speeds, cos * x - sin * z, cos * z + sin * x]) * per_second


def _resting(track: BodyTrack) -> FloatArray:
    """(14, N) RESTING."""
    local = dict(zip(SUN_ROLES, track.local.transpose(1, 2, 0), strict=True))  # (3, N) each
    heights = dict(zip(SUN_ROLES, track.positions[:, :, 1].T / track.body_length, strict=True))
    neck, left_foot, right_foot = local[_R.NECK], local[_R.LEFT_FOOT], local[_R.RIGHT_FOOT]
    left_hand, right_hand = local[_R.LEFT_HAND], local[_R.RIGHT_HAND]
    knees = local[_R.LEFT_KNEE][1], local[_R.RIGHT_KNEE][1]
    return np.stack(
        [
            track.heading,
            np.min(list(heights.values()), axis=0),
            np.minimum(heights[_R.LEFT_FOOT], heights[_R.RIGHT_FOOT]),
            heights[_R.HIPS],
            np.maximum(left_hand[1], right_hand[1]) - neck[1],
            np.minimum(left_hand[1], right_hand[1]) - neck[1],
            left_foot[1],
            right_foot[1],
            np.maximum(left_foot[1], right_foot[1]),
            np.maximum(*knees),
            np.hypot(neck[0], neck[2]),
            neck[2],
            np.sqrt(np.square(left_hand - right_hand).sum(axis=0)),
            np.sqrt(np.square(left_foot - right_foot).sum(axis=0)),
        ]
    )
