"""The body frame: a motion without its position, heading, size and frame rate.

The origin is at the hips. X points to the left of the body, along the horizontal part of the line
between the shoulders. Y points up and Z points forward (right-handed). The unit is the body length:
torso + neck to head + shin.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.errors import NotHuman, TooShort
from app.kinedex_error import Place
from app.motion.frame.posed_start import with_held_start
from app.motion.motion import Motion
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.resampling import resample
from app.motion.skeleton.smoothing import cut_off_of, low_passed
from app.numerics.arrays import BoolArray, FloatArray
from app.numerics.differences import central_differences
from app.numerics.quantiles import median

ANALYSIS_RATE = 30.0
"""Hz: the rate at which all motions are analyzed."""

MIN_FRAMES = 2
"""The fewest frames at the analysis rate. Fewer contain no movement."""

NECK_TO_HEAD_PER_TORSO = 0.3
SHIN_PER_TORSO = 0.85
"""Usual proportions, used for joints that a skeleton does not have."""

MIN_AXIS_SHARE = 0.2
"""The smallest horizontal share of the line from right to left. With less, it has no heading."""

MIN_BODY_SIZE = 1e-6
"""A smaller body length or line from right to left, in the unit of the positions, counts as 0."""

_LEFT_RIGHT: tuple[tuple[JointRole, JointRole], ...] = (
    (JointRole.LEFT_SHOULDER, JointRole.RIGHT_SHOULDER),
    (JointRole.LEFT_UPPER_LEG, JointRole.RIGHT_UPPER_LEG),
    (JointRole.LEFT_KNEE, JointRole.RIGHT_KNEE),
)
_MEASURED: tuple[tuple[JointRole, JointRole], ...] = (
    (JointRole.HIPS, JointRole.NECK),
    (JointRole.NECK, JointRole.HEAD),
    (JointRole.LEFT_KNEE, JointRole.LEFT_FOOT),
    (JointRole.RIGHT_KNEE, JointRole.RIGHT_FOOT),
)
"""The ends of the parts of the body length: torso, neck to head, and both shins."""


@dataclass(frozen=True, slots=True)
class BodyTrack:
    """A body over time at ANALYSIS_RATE: n frames, 13 joints in SUN_ROLES order, float64.

    positions: (n, 13, 3) in the world, meters, Y up. local: (n, 13, 3) in the body frame, body
    lengths. origin: (n, 3) the hips in the world, meters. heading: (n,) radians, unwrapped: the
    turn about Y that takes the world's Z to the body's forward. body_length: meters. rate: Hz.
    """

    positions: FloatArray
    local: FloatArray
    origin: FloatArray
    heading: FloatArray
    body_length: float
    rate: float = ANALYSIS_RATE

    @property
    def frames(self) -> int:
        """The number of frames."""
        return len(self.heading)

    @property
    def duration(self) -> float:
        """Seconds: frames / rate."""
        return self.frames / self.rate

    def part(self, first: int, stop: int) -> BodyTrack:
        """The frames first .. stop - 1, with the body length of the whole motion."""
        cut = slice(first, stop)
        return BodyTrack(
            positions=self.positions[cut],
            local=self.local[cut],
            origin=self.origin[cut],
            heading=self.heading[cut],
            body_length=self.body_length,
            rate=self.rate,
        )

    def velocity(self) -> FloatArray:
        """(n, 3) the velocity of the hips in the body frame, body lengths per second."""
        steps = central_differences(self.origin) * (self.rate / self.body_length)
        return turned(steps[:, None], -self.heading)[:, 0]

    def yaw_rate(self) -> FloatArray:
        """(n,) the rate of turning about Y, radians per second, positive to the left."""
        return central_differences(self.heading) * self.rate


def body_track(motion: Motion) -> BodyTrack:
    """The track of the body in `motion`, resampled to ANALYSIS_RATE.

    A pose at the start that does not belong to the motion is replaced by the first pose of the
    motion (app.motion.frame.posed_start). Raises TooShort for fewer than MIN_FRAMES frames at that
    rate, and NotHuman for a body without size.
    """
    return _of_readings(_read(with_held_start(motion)))


def smooth_track(motion: Motion) -> BodyTrack:
    """As `body_track`, of smoothed positions (app.motion.skeleton.smoothing).

    Descriptors are computed from it. Energies are not: they have a model of the noise that needs
    to see it. The filter runs at ANALYSIS_RATE, so that a motion is the same at any frame rate.
    """
    return _of_readings(_smoothed(_read(with_held_start(motion))))


def both_tracks(motion: Motion) -> tuple[BodyTrack, BodyTrack]:
    """`body_track` and `smooth_track` of a motion, which share most of their work."""
    readings = _read(with_held_start(motion))
    return _of_readings(readings), _of_readings(_smoothed(readings))


@dataclass(frozen=True, slots=True)
class _Readings:
    """What a track is made of, at ANALYSIS_RATE, in meters.

    positions: (n, 13, 3). left: (n, 3) the line from right to left, None if there is none.
    """

    positions: FloatArray
    left: FloatArray | None
    body_length: float


def _read(motion: Motion) -> _Readings:
    """Raises TooShort and NotHuman."""
    positions = _at_analysis_rate(motion.role_positions(), motion.frame_rate)
    left = _left_axis(motion)
    if len(positions) < MIN_FRAMES:
        seconds = MIN_FRAMES / ANALYSIS_RATE
        message = f"expected at least {seconds:.2f} s, found {motion.duration:.3f} s"
        raise TooShort(
            f"The motion has {motion.frames} frames; {seconds:.2f} s are needed.",
            places=[Place("frames", message)],
        )
    return _Readings(positions, left, body_length(motion))


def _smoothed(readings: _Readings) -> _Readings:
    cut_off = cut_off_of(readings.positions, ANALYSIS_RATE)
    left = readings.left
    return replace(
        readings,
        positions=low_passed(readings.positions, ANALYSIS_RATE, cut_off),
        left=None if left is None else low_passed(left, ANALYSIS_RATE, cut_off),
    )


def _of_readings(readings: _Readings) -> BodyTrack:
    positions, length = readings.positions, readings.body_length
    heading = _heading(readings.left, len(positions))
    origin = positions[:, SUN_ROLES.index(JointRole.HIPS)]
    local = turned(positions - origin[:, None], -heading) / length
    return BodyTrack(positions, local, origin, heading, length)


def body_length(motion: Motion) -> float:
    """The body length in meters: torso + neck to head + shin, each the median over frames.

    A missing head or foot counts with its usual proportion to the torso. Raises NotHuman for a
    body without size.
    """
    torso, head, *shins = _distances(motion, _MEASURED)
    torso = torso or 0.0
    known = [shin for shin in shins if shin is not None]
    length = torso + (torso * NECK_TO_HEAD_PER_TORSO if head is None else head)
    length += float(np.mean(known)) if known else torso * SHIN_PER_TORSO
    if not length > MIN_BODY_SIZE:
        message = "hips, neck, head, knees and feet all have the same position"
        raise NotHuman(f"The body has no size: {message}.", places=[Place("joints", message)])
    return length


def turned(points: FloatArray, angles: FloatArray) -> FloatArray:
    """(n, joints, 3) `points` turned about Y by `angles` (n,), in radians, from Z toward X."""
    cos, sin = np.cos(angles)[:, None], np.sin(angles)[:, None]
    x, z = points[..., 0], points[..., 2]
    result = np.empty_like(points)
    result[..., 0] = cos * x + sin * z
    result[..., 1] = points[..., 1]
    result[..., 2] = cos * z - sin * x
    return result


def _at_analysis_rate(positions: FloatArray, rate: float) -> FloatArray:
    return resample(positions.astype(np.float64), rate, ANALYSIS_RATE)


def _distances(motion: Motion, pairs: Sequence[tuple[JointRole, JointRole]]) -> list[float | None]:
    """The median distance in meters of each pair of roles; None if one of them is missing."""
    roles = motion.roles
    found = [pair for pair in pairs if all(role in roles for role in pair)]
    ones, others = ([roles[pair[end]] for pair in found] for end in (0, 1))
    lines = motion.positions[:, ones] - motion.positions[:, others]
    medians = median(np.linalg.norm(lines.astype(np.float64), axis=-1))
    by_pair = dict(zip(found, medians.tolist(), strict=True))
    return [by_pair.get(pair) for pair in pairs]


def _left_axis(motion: Motion) -> FloatArray | None:
    """(n, 3) the line from right to left, in meters, at ANALYSIS_RATE.

    It is that of the first pair of joints whose line is level enough in some frame. None if there
    is no pair.
    """
    for left, right in _LEFT_RIGHT:
        if left not in motion.roles or right not in motion.roles:
            continue
        ends = motion.positions[:, [motion.roles[left], motion.roles[right]]]
        line = _at_analysis_rate(ends[:, 0] - ends[:, 1], motion.frame_rate)
        if _gives_heading(line).any():
            return line
    return None


def _gives_heading(line: FloatArray) -> BoolArray:
    """(n,) whether `line` (n, 3) is level enough and long enough to give a heading."""
    across = np.hypot(line[:, 0], line[:, 2])
    min_width = np.maximum(MIN_AXIS_SHARE * np.linalg.norm(line, axis=1), MIN_BODY_SIZE)
    return np.asarray(across > min_width)


def _heading(left: FloatArray | None, frames: int) -> FloatArray:
    """(frames,) the unwrapped heading in radians, from the line `left` (frames, 3).

    It is interpolated in frames in which the line is upright. Without a line, the heading is 0: the
    body faces along Z.
    """
    if left is None:
        return np.zeros(frames)
    good = np.flatnonzero(_gives_heading(left))
    angles = np.unwrap(np.arctan2(-left[good, 2], left[good, 0]))
    return np.asarray(np.interp(np.arange(frames), good, angles))
