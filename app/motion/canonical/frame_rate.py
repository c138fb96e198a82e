"""Checks by physics whether a frame rate is plausible for a human body.

If the declared rate is k times the true one, speeds seem k times and accelerations k^2 times too
large. Five laws are checked that no body can break:

1. Free fall. While both feet are off the floor, the height of the center of mass is a parabola of
   curvature g. So flights show rates that are too high and rates that are too low.
2. Ground friction. Only friction moves a body sideways. A foot slips if it needs a force larger
   than about the weight on it (coefficient of friction .5 to 1). The demand is the horizontal
   acceleration of the center of mass divided by (g + its vertical acceleration). Ballet, fights
   and sprints have a high demand for moments; nobody has it for a quarter of the time in which the
   feet bear about the weight of the body. (A dance of hops has demands of 1 near its flights.)
3. Support. Only its weight pulls a body down, so it does not fall faster than g.
4. Speed. Nobody travels faster than a sprinter (Bolt 2009: 12.4 m/s).
5. Steps. The leg is a pendulum: step frequency x sqrt(leg length / g) is below that of the
   fastest sprinters (about 5 steps/s with legs of .9 m: 1.5).

6. Slow steps. Nobody walks with steps of ten seconds; slow dances may have some of five.

A rate that is too low only shows in flights and slow steps, because slow motion breaks no other
law.

Real clips at their true rates have a friction demand of at most .38 (n = 381), fall with at most
1.33 g, have flights of .81 to 1.26 g, and steps of at most 1.09. At twice their rate, a quarter of
the clips that still last 3 s are detected, and nearly all at four times. (Gestures of a standing
person obey each law even at twice their speed.)

All laws but the last two depend on the size of the body. If its unit is a guess, they are not used.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.motion.canonical.center_of_mass import center_of_mass
from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.smoothing import butterworth, there_and_back
from app.numerics.arrays import FloatArray
from app.numerics.differences import point_reflected
from app.numerics.quantiles import median, quantile

GRAVITY = 9.81
"""m/s2."""
CUTOFF = 4.0
"""Hz. Faster changes of the center of mass are mostly noise."""
MIN_SECONDS = 3.0
"""Seconds at the checked rate. A shorter clip may be a single start, stop or leap."""
MIN_FRAMES = 30
"""The fewest frames for the laws about accelerations and speeds."""
EDGE = 0.25
"""Seconds at each end that are left out, because the filter is not exact there."""
FRICTION_QUANTILE, MAX_FRICTION = 75.0, 0.45
"""The percentile of the friction demand, and its largest value (force / weight on the foot)."""
USUAL_LOAD, MIN_LOADED_SHARE = (0.6, 1.6), 0.5
"""The load of the feet, in weights of the body, in which friction is judged, and the smallest share
of frames with such a load."""
SUPPORT_QUANTILE, MIN_SUPPORT = 2.0, -1.7
"""The percentile of the vertical acceleration, and its smallest value in g."""
SPEED_QUANTILE, MAX_SPEED = 95.0, 12.5
"""The percentile of the speed, and its largest value in m/s."""
MAX_PACE = 1.7
"""The largest step frequency x sqrt(leg length / g), without unit."""
MIN_STEP_LENGTH, MIN_STEPS = 0.2, 6
"""The shortest step in leg lengths, and the fewest steps."""
STEP_CUTOFF = 8.0
"""Hz. Faster changes of the feet are mostly noise."""
MIN_CLEARANCE = 0.12
"""Meters: the smallest height of both feet in flight, above the height at which they stand."""
MIN_FLIGHT_FRAMES, MIN_FLIGHT_RISE, MAX_FLIGHT_MISFIT = 6, 0.05, 0.05
"""The fewest frames of a flight; the smallest rise of the hips and the center of mass in meters;
the largest distance from the parabola, as a share of the rise."""
FLIGHT_LIMITS = (0.5, 2.0)
"""The smallest and the largest plausible gravity in g. Outside, the rate is wrong by a factor of
sqrt(2) or more."""
FACTORS = (2.0, 3.0, 4.0, 5.0, 8.0)
"""The usual factors of wrong rates: frames dropped or doubled, or 120 Hz in place of 60 or 30."""

USUAL_RATES = (24.0, 25.0, 30.0, 50.0, 60.0, 100.0, 120.0)
"""Hz."""
MIN_PACE, USUAL_PACE = 0.04, 0.5
"""The smallest step frequency x sqrt(leg length / g) of steps in a walk, and that of a usual walk
(1.65 steps/s with legs of .9 m)."""
MIN_SLOW_STEPS, MIN_SLOW_STEP_LENGTH = 3, 0.4
"""The fewest slow steps, and their shortest length in leg lengths."""

_ROLE = {role: index for index, role in enumerate(SUN_ROLES)}


@dataclass(frozen=True, slots=True)
class _Finding:
    """A law that a rate breaks. factor: the rate is too high at least by it; below 1: too low."""

    factor: float
    reason: str


def judge_frame_rate(
    role_positions: FloatArray, rate: float, *, is_unit_sure: bool = True
) -> list[Caution]:
    """Check a frame rate in Hz against the laws of this module.

    role_positions: (frames, 13, 3) in SUN_ROLES order, meters, Y up. is_unit_sure: whether the
    meters are no guess. The result is empty, or one caution `frame_rate_suspect` with the likely
    rate.
    """
    # Converters often insert a rest pose as the first frame.
    positions = np.asarray(role_positions[1:], dtype=np.float64)
    laws = _findings if is_unit_sure else _steps_alone
    finding = next(laws(positions, rate), None)
    if finding is None:
        return []
    likely = _likely_rate(positions, rate, finding.factor)
    detail = f"at {rate:g} Hz {finding.reason}; the true rate is likely {likely:g} Hz"
    return [Caution("frame_rate_suspect", detail, likely=likely)]


def _likely_rate(positions: FloatArray, rate: float, factor: float) -> float:
    """The likely rate, by one of FACTORS.

    For a rate that is too low it is the nearest factor, or the nearest usual rate if that is much
    larger; else the first one that breaks no law.
    """
    if factor < 1 / FACTORS[-1]:
        return min(USUAL_RATES, key=lambda usual: abs(np.log(usual * factor / rate)))
    if factor < 1:
        return rate * min(FACTORS, key=lambda usual: abs(np.log(usual * factor)))
    plausible = (
        rate / usual
        for usual in FACTORS
        if usual >= factor and next(_findings(positions, rate / usual), None) is None
    )
    return next(plausible, rate / FACTORS[-1])


def _findings(positions: FloatArray, rate: float) -> Iterator[_Finding]:
    """The laws that the rate breaks, the most reliable law first."""
    if len(positions) < MIN_FLIGHT_FRAMES:
        return
    center = center_of_mass(positions)
    yield from _free_fall(positions, center, rate)
    yield from _steps(positions, rate)
    if len(positions) < max(MIN_SECONDS * rate, MIN_FRAMES):
        return
    smooth = _low_pass(center, rate, CUTOFF)
    edge = max(1, round(EDGE * rate))
    acceleration = np.diff(smooth, 2, axis=0)[edge:-edge] * rate**2 / GRAVITY
    yield from _friction(acceleration)
    yield from _support(acceleration)
    yield from _speed(np.diff(smooth, axis=0) * rate)


def _free_fall(positions: FloatArray, center: FloatArray, rate: float) -> Iterator[_Finding]:
    """positions: (frames, 13, 3); center: (frames, 3) the center of mass; both in meters."""
    gravities = [
        float(-2 * curve[0]) * rate**2 / GRAVITY
        for start, end in _flights(positions)
        if (
            curve := _parabola(center[start:end, 1], positions[start:end, _ROLE[JointRole.HIPS], 1])
        )
        is not None
    ]
    if (
        gravities
        and not FLIGHT_LIMITS[0] <= (pull := float(np.median(gravities))) <= FLIGHT_LIMITS[1]
    ):
        # Other laws only give a bound of the factor. Flights give its value.
        factor = pull**0.5
        near = min(FACTORS, key=lambda usual: abs(np.log(usual / factor)))
        yield _Finding(
            near if factor > 1 else factor, f"the body falls with {pull:.2g} g in flight"
        )


def _flights(positions: FloatArray) -> list[tuple[int, int]]:
    """The start and the end (exclusive) of each flight; positions: (frames, 13, 3) meters."""
    feet = positions[:, [_ROLE[JointRole.LEFT_FOOT], _ROLE[JointRole.RIGHT_FOOT]], 1]
    clear = np.all(feet > quantile(feet, 0.05) + MIN_CLEARANCE, axis=1)
    edges = np.flatnonzero(np.diff(np.r_[0, clear.astype(np.int8), 0]))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2) if b - a >= MIN_FLIGHT_FRAMES]


def _parabola(height: FloatArray, hips: FloatArray) -> FloatArray | None:
    """(3,) the coefficients of the parabola of a flight, highest power first, time in frames.

    height, hips: (frames,) the heights of the center of mass and of the hips, in meters. None if
    the movement is not a flight.
    """
    rise = float(np.ptp(height))
    if min(rise, float(np.ptp(hips))) < MIN_FLIGHT_RISE or int(np.argmax(height)) in (
        0,
        len(height) - 1,
    ):
        return None
    frames = np.arange(len(height))
    curve = np.polyfit(frames, height, 2)
    misfit = float(np.abs(height - np.polyval(curve, frames)).max())
    return curve if curve[0] < 0 and misfit < MAX_FLIGHT_MISFIT * rise else None


def _friction(acceleration: FloatArray) -> Iterator[_Finding]:
    """acceleration: (frames, 3) that of the center of mass in g."""
    load = 1 + acceleration[:, 1]
    loaded = (load > USUAL_LOAD[0]) & (load < USUAL_LOAD[1])
    if np.mean(loaded) < MIN_LOADED_SHARE:
        return
    sideways = np.hypot(acceleration[loaded, 0], acceleration[loaded, 2])
    demand = float(quantile(sideways / load[loaded], FRICTION_QUANTILE / 100))
    if demand > MAX_FRICTION:
        yield _Finding(
            (demand / MAX_FRICTION) ** 0.5,
            f"the feet would need a grip of {demand:.2f} of their load for a quarter of the time",
        )


def _support(acceleration: FloatArray) -> Iterator[_Finding]:
    """acceleration: (frames, 3) that of the center of mass in g."""
    fall = float(quantile(acceleration[:, 1], SUPPORT_QUANTILE / 100))
    if fall < MIN_SUPPORT:
        yield _Finding(abs(fall) ** 0.5, f"the body falls with {-fall:.1f} g")


def _speed(velocity: FloatArray) -> Iterator[_Finding]:
    """velocity: (frames, 3) that of the center of mass in m/s."""
    speed = float(quantile(np.linalg.norm(velocity, axis=1), SPEED_QUANTILE / 100))
    if speed > MAX_SPEED:
        yield _Finding(speed / MAX_SPEED, f"the body travels at {speed:.0f} m/s")


def _steps_alone(positions: FloatArray, rate: float) -> Iterator[_Finding]:
    """The laws that do not need meters: a pace hardly changes with the size of the body."""
    if len(positions) >= MIN_FLIGHT_FRAMES:
        yield from _steps(positions, rate)


def _steps(positions: FloatArray, rate: float) -> Iterator[_Finding]:
    """positions: (frames, 13, 3) in meters. A step ends when the other foot passes the first."""
    leg, lines = _leg_length(positions), _side_lines(positions)
    if float(np.abs(lines[:, 1, ::2]).max()) < MIN_STEP_LENGTH * leg / 2:
        return  # the feet are never far enough apart, so the filter is not needed
    stride = _fore_aft(*_low_pass(lines, rate, STEP_CUTOFF).swapaxes(0, 1))
    crossings = np.flatnonzero(np.diff(np.sign(stride)))
    steps = [(b - a, float(np.abs(stride[a : b + 1]).max())) for a, b in pairwise(crossings)]
    times = [frames for frames, length in steps if length > MIN_STEP_LENGTH * leg]
    slow = [frames for frames, length in steps if length > MIN_SLOW_STEP_LENGTH * leg]
    if len(times) >= MIN_STEPS:
        frequency = rate / float(np.median(times))
        pace = frequency * (leg / GRAVITY) ** 0.5
        if pace > MAX_PACE:
            yield _Finding(pace / MAX_PACE, f"the legs take {frequency:.1f} steps a second")
    if len(slow) >= MIN_SLOW_STEPS:
        seconds = float(np.median(slow)) / rate
        pace = (leg / GRAVITY) ** 0.5 / seconds
        if pace < MIN_PACE:
            yield _Finding(pace / USUAL_PACE, f"a step takes {seconds:.0f} s")


def _leg_length(positions: FloatArray) -> float:
    hips, knee, foot = (
        positions[:, _ROLE[role]]
        for role in (JointRole.HIPS, JointRole.LEFT_KNEE, JointRole.LEFT_FOOT)
    )
    thigh, shank = (np.linalg.norm(bone, axis=1) for bone in (hips - knee, knee - foot))
    return float(median(thigh + shank))


def _side_lines(positions: FloatArray) -> FloatArray:
    """(frames, 2, 3) from the right shoulder to the left one, and from the right foot to the left.

    positions: (frames, 13, 3). Without shoulders, the knees are used.
    """
    shoulders, knees, feet = (
        positions[:, _ROLE[JointRole(f"left_{part}")]]
        - positions[:, _ROLE[JointRole(f"right_{part}")]]
        for part in ("shoulder", "knee", "foot")
    )
    return np.stack([shoulders if np.any(shoulders) else knees, feet], axis=1)


def _fore_aft(across: FloatArray, feet: FloatArray) -> FloatArray:
    """(frames,) the distance of the left foot ahead of the right one, in meters.

    across: (frames, 3) a line from right to left. feet: (frames, 3) from the right foot to the
    left one.
    """
    # Forward is horizontal and at right angles to the line from right to left.
    forward = np.stack([-across[:, 2], across[:, 0]], axis=1)
    forward /= np.maximum(np.linalg.norm(forward, axis=1, keepdims=True), 1e-9)
    return np.asarray(np.sum(feet[:, [0, 2]] * forward, axis=1))


def _low_pass(samples: FloatArray, rate: float, cutoff: float) -> FloatArray:
    """`samples` (frames, ...) without frequencies above `cutoff` Hz, and without a delay."""
    # A filter near half of the rate is not stable, and there is little to remove.
    if cutoff >= 0.45 * rate:
        return samples
    padding = min(len(samples) - 1, round(rate))
    filtered = there_and_back(butterworth(rate, cutoff), point_reflected(samples, padding))
    return filtered[padding : padding + len(samples)]
