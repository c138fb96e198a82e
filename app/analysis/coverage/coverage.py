"""Speeds, turns and directions of motions, as seconds in cells: what motion matching needs.

Motion matching (Clavet, "Motion Matching and the Road to Next-Gen Animation", GDC 2016) plays the
recorded frame whose path fits the wanted one best. So a set is good if it holds every speed at
every rate of turning that will be asked for, on both sides. Velocities are means over SMOOTHED
seconds, so that the sway of a step is no turn.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import uniform_filter1d

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.numerics.arrays import FloatArray

SPEED_EDGES = (0.0, 0.1, 0.5, 1.0, 1.5, 2.0, 3.0, 4.5)
"""Meters per second: the lower edges of the cells; the last one has no upper edge."""
TURN_EDGES = (-180.0, -90.0, -30.0, 30.0, 90.0, 180.0)
"""Degrees per second, to the left positive: between the cells, of which the first and the last are
open."""
DIRECTIONS = ("forward", "left", "backward", "right")
MIN_SPEED = 0.3
"""Meters per second: a slower body goes in no direction."""
SMOOTHED = 0.5
"""Seconds of the mean of a velocity."""
ENOUGH_SECONDS = 1.0
"""A cell with less is not covered."""

_HIPS = SUN_ROLES.index(JointRole.HIPS)
_ACROSS = (
    (SUN_ROLES.index(JointRole.LEFT_SHOULDER), SUN_ROLES.index(JointRole.RIGHT_SHOULDER)),
    (SUN_ROLES.index(JointRole.LEFT_KNEE), SUN_ROLES.index(JointRole.RIGHT_KNEE)),
)


@dataclass(frozen=True, slots=True)
class Coverage:
    """Seconds in cells.

    cells: (speeds, turns) by SPEED_EDGES and TURN_EDGES; directions: (4,) by DIRECTIONS.
    """

    cells: FloatArray
    directions: FloatArray

    @classmethod
    def nothing(cls) -> Coverage:
        """No seconds anywhere."""
        return cls(np.zeros((len(SPEED_EDGES), len(TURN_EDGES) + 1)), np.zeros(len(DIRECTIONS)))

    def __add__(self, other: Coverage) -> Coverage:
        return Coverage(self.cells + other.cells, self.directions + other.directions)

    @property
    def seconds(self) -> float:
        """All seconds."""
        return float(self.cells.sum())

    def mirrored(self) -> Coverage:
        """The coverage of the mirrored motions: turns to the other side."""
        forward, left, backward, right = self.directions
        return Coverage(self.cells[:, ::-1], np.array([forward, right, backward, left]))


def coverage_of(positions: FloatArray, rate: float = ANALYSIS_RATE) -> Coverage:
    """The coverage of one motion.

    positions: (n, 13, 3) meters, world, Y up, in SUN_ROLES order. rate: Hz.
    """
    if len(positions) < 2:
        return Coverage.nothing()
    place = positions[:, _HIPS, ::2].astype(np.float64)  # (n, 2) X and Z
    heading = _heading(positions)
    velocity = _smoothed(np.gradient(place, axis=0) * rate, rate)
    speed = np.hypot(*velocity.T)
    turn = np.degrees(_smoothed(np.gradient(heading) * rate, rate))
    speeds = np.searchsorted(SPEED_EDGES, speed, side="right") - 1
    turns = np.searchsorted(TURN_EDGES, turn, side="right")
    nothing = Coverage.nothing()
    np.add.at(nothing.cells, (speeds, turns), 1.0 / rate)
    course = np.arctan2(velocity[:, 0], velocity[:, 1]) - heading
    quarter = np.round(course / (np.pi / 2)).astype(int) % len(DIRECTIONS)
    is_going = speed >= MIN_SPEED
    np.add.at(nothing.directions, quarter[is_going], 1.0 / rate)
    return nothing


def _heading(positions: FloatArray) -> FloatArray:
    """(n,) the turn about Y from the world's Z to the body's forward, radians, unwrapped."""
    for left, right in _ACROSS:
        line = (positions[:, left] - positions[:, right]).astype(np.float64)
        if np.hypot(line[:, 0], line[:, 2]).max() > 0:
            return np.unwrap(np.arctan2(-line[:, 2], line[:, 0]))
    return np.zeros(len(positions))


def _smoothed(values: FloatArray, rate: float) -> FloatArray:
    size = max(1, round(SMOOTHED * rate))
    return np.asarray(uniform_filter1d(values, size, axis=0, mode="nearest"))
