"""Walking and running: feet planted in the world, the body carried over them.

Phase is in strides; the left foot strikes at phase 0, the right half a stride later. Ordinary
step lengths, duty factors and joint courses are those of Winter 2009 (walking) and
Novacheck 1998, The biomechanics of running (Gait & Posture 7).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, radians

import numpy as np

from app.demo.controls import Controls, Foot, Turn, bent, standing
from app.demo.curves import Key, keyed, periodic, softened
from app.demo.performance import Performance
from app.demo.posing import highest_root
from app.demo.rig import LEFT, RIGHT, SIDES
from app.demo.take import GRAVITY, Take
from app.numerics.arrays import FloatArray

NEARLY_STRAIGHT = 0.9985
"""The most of a leg's length that is used in going: knees stretch further than at ease."""


@dataclass(frozen=True, slots=True)
class Gait:
    """One way of going; times in s, lengths in leg lengths, angles in rad.

    stride_time of an average leg; stride: length; duty: share of the stride that a foot
    stands; ahead: share of that way at which it lands before the hips; pitch: keys over the
    stride (0 strike, duty toe-off); travel: keys (share of swing, share of way); lift: keys
    (share of swing, clearance); elbow: (base, swing); swing: arm amplitude; lean: trunk.
    """

    stride_time: float
    stride: float
    duty: float
    ahead: float
    pitch: tuple[Key, ...]
    travel: tuple[Key, ...]
    lift: tuple[Key, ...]
    elbow: tuple[float, float]
    swing: float
    lean: float


WALK = Gait(
    stride_time=1.08,
    stride=1.54,
    duty=0.61,
    ahead=0.375,
    pitch=(
        (0.0, radians(18)),
        (0.07, 0.0),
        (0.22, 0.0),
        (0.36, radians(-7)),
        (0.5, radians(-27)),
        (0.61, radians(-60)),
        (0.7, radians(-52)),
        (0.83, radians(-4)),
        (0.93, radians(16)),
    ),
    travel=(
        (0.0, 0.0),
        (0.06, 0.008),
        (0.2, 0.11),
        (0.5, 0.54),
        (0.8, 0.93),
        (0.95, 1.0),
        (1.0, 1.0),
    ),
    lift=((0.0, 0.0), (0.06, 0.006), (0.25, 0.035), (0.55, 0.03), (0.8, 0.033), (1.0, 0.0)),
    elbow=(0.0, radians(14)),
    swing=radians(21),
    lean=0.0,
)
RUN = Gait(
    stride_time=0.72,
    stride=2.35,
    duty=0.35,
    ahead=0.31,
    pitch=(
        (0.0, radians(6)),
        (0.05, 0.0),
        (0.16, radians(-2)),
        (0.35, radians(-58)),
        (0.5, radians(-95)),
        (0.62, radians(-88)),
        (0.82, radians(-18)),
        (0.95, radians(8)),
    ),
    travel=(
        (0.0, 0.0),
        (0.05, 0.014),
        (0.16, 0.1),
        (0.5, 0.52),
        (0.8, 0.9),
        (0.95, 0.995),
        (1.0, 1.0),
    ),
    lift=(
        (0.0, 0.0),
        (0.05, 0.014),
        (0.15, 0.12),
        (0.36, 0.34),
        (0.62, 0.24),
        (0.83, 0.08),
        (0.95, 0.01),
        (1.0, 0.0),
    ),
    elbow=(radians(70), radians(18)),
    swing=radians(32),
    lean=radians(8),
)


def walk(take: Take) -> Performance:
    """Walking ahead on a gentle arc, 4 to 5 s."""
    return _go(take, WALK, seconds=4.6 * take.vary(0.12))


def run(take: Take) -> Performance:
    """Running ahead with a flight between the steps, 3 to 4 s."""
    return _go(take, RUN, seconds=3.4 * take.vary(0.12))


def _go(take: Take, gait: Gait, seconds: float) -> Performance:
    times, style, rig = take.clock(seconds), take.actor.style, take.rig
    # Froude: the time of a stride grows with the square root of the leg.
    stride_time = gait.stride_time * np.sqrt(rig.leg / 0.85) / take.pace**0.6
    stride = gait.stride * rig.leg * style.step * take.size**0.35
    phase = take.phase + times / stride_time
    still = standing(take.actor, rig, len(times))
    feet = [_foot(take, gait, still.feet[s], times, phase + 0.5 * s, s, stride) for s in SIDES]
    controls = replace(still, feet=(feet[LEFT], feet[RIGHT]))
    controls = _trunk(controls, take, gait, phase)
    controls = _arms(controls, take, gait, phase)
    controls = _carried(controls, take, gait, phase, stride, stride_time)
    curvature = float(take.draw.uniform(-0.06, 0.06))
    return Performance(times, bent(controls, take.heading, curvature))


def _foot(
    take: Take,
    gait: Gait,
    still: Foot,
    times: FloatArray,
    phase: FloatArray,
    side: int,
    stride: float,
) -> Foot:
    """A foot that stands still for `duty` of each stride and then swings to the next place."""
    style = take.actor.style
    count, within = np.divmod(phase, 1.0)
    swing = np.clip((within - gait.duty) / (1.0 - gait.duty), 0.0, 1.0)
    landing = (count - 0.5 * side + gait.ahead * gait.duty) * stride
    place = still.place.copy()
    place[:, 0] *= _narrowing(gait)
    # A run lifts the feet high anyway; there is less room for style before the thigh is met.
    eager = (style.knee_lift * take.size) ** (0.7 if gait is WALK else 0.3)
    place[:, 1] = keyed(swing, gait.lift) * take.rig.leg * eager
    place[:, 2] = landing + stride * keyed(swing, gait.travel)
    pitch = periodic(within, gait.pitch) * (0.55 + 0.45 * min(style.energy, 1.1))
    pitch = softened(pitch, times, 0.015)
    return Foot(place=place, pitch=pitch, yaw=still.yaw * (0.8 if gait is WALK else 0.4))


def _narrowing(gait: Gait) -> float:
    """How much closer to the middle line the feet come than when standing."""
    return 0.6 if gait is WALK else 0.3


def _trunk(controls: Controls, take: Take, gait: Gait, phase: FloatArray) -> Controls:
    """Pelvis and shoulders turn against each other; the head looks ahead."""
    style = take.actor.style
    turn = 2.0 * pi * (phase if gait is WALK else phase + 0.08)
    # At the left foot's strike (phase 0) the left hip is ahead: the pelvis is turned right.
    yaw = -radians(5) * style.twist * np.cos(turn)
    roll = radians(3.2) * style.sway**0.7 * np.cos(turn - 2.0 * pi * 0.18)
    nod = radians(1.5) * style.bounce * np.cos(2.0 * turn)
    lean = gait.lean * take.size
    pelvis = Turn(yaw, controls.pelvis.pitch + 0.4 * lean, roll)
    spine = Turn(
        -1.9 * yaw, controls.spine.pitch + 0.6 * lean + nod, controls.spine.roll - 1.1 * roll
    )
    head = Turn(0.9 * yaw, controls.head.pitch - 0.8 * lean - nod, controls.head.roll + 0.1 * roll)
    return replace(controls, pelvis=pelvis, spine=spine, head=head)


def _arms(controls: Controls, take: Take, gait: Gait, phase: FloatArray) -> Controls:
    """Each arm swings with the other side's leg, the elbow bending on the way forward."""
    style = take.actor.style
    base, bend = gait.elbow
    # A runner's feet are furthest apart in the air, some way before the strike.
    early = 0.0 if gait is WALK else 0.12
    arms = []
    for side in SIDES:
        arm = controls.arms[side]
        forward = -np.cos(2.0 * pi * (phase + 0.5 * side + early - 0.03))
        late = -np.cos(2.0 * pi * (phase + 0.5 * side + early - 0.08))
        swing = gait.swing * style.arm_swing * take.size
        arms.append(
            replace(
                arm,
                flex=arm.flex + swing * (forward - 0.1 - 0.25 * (gait is RUN)),
                abduct=arm.abduct + radians(2) + 0.05 * (1 + forward) * (gait is RUN),
                twist=arm.twist + 0.35 * (1.0 + forward) * (gait is RUN),
                elbow=arm.elbow * (0.8 if gait is WALK else 0.35)
                + base
                + bend * style.arm_swing * (1.0 + late),
            )
        )
    return replace(controls, arms=(arms[LEFT], arms[RIGHT]))


def _carried(
    controls: Controls,
    take: Take,
    gait: Gait,
    phase: FloatArray,
    stride: float,
    stride_time: float,
) -> Controls:
    """The pelvis moves on, over the standing foot, and up and down with the steps."""
    style, rig = take.actor.style, take.rig
    over = (gait.duty * 0.5, 0.02 * style.sway * (1.0 if gait is WALK else 0.4))
    root = controls.root.copy()
    root[:, 0] += over[1] * np.cos(2.0 * pi * (phase - over[0]))
    root[:, 2] += phase * stride + 0.004 * np.sin(4.0 * pi * (phase - 0.1)) * stride
    if gait is WALK:
        root[:, 1] = _vault(phase, gait) * style.bounce * rig.leg
    else:
        root[:, 1] = _bound(phase, gait, stride_time)
    trial = replace(controls, root=root)
    room = np.min(highest_root(trial, rig, NEARLY_STRAIGHT) - root[:, 1])
    low = np.min(rig.standing - 0.6 * style.crouch * rig.leg - np.max(root[:, 1]))
    # The small sway that is added later must not stretch a leg beyond its reach.
    root[:, 1] += min(room - 0.004 * rig.leg, low)
    return replace(controls, root=root)


def _vault(phase: FloatArray, gait: Gait) -> FloatArray:
    """Walking: highest over the middle of each stance, about 4 cm from low to high; leg lengths."""
    return np.asarray(0.024 * np.cos(4.0 * pi * (phase - 0.5 * gait.duty)))


def _bound(phase: FloatArray, gait: Gait, stride_time: float) -> FloatArray:
    """Running: free fall while no foot stands, a sine below it while one does, meters."""
    within = np.mod(phase, 0.5) * stride_time
    stand = gait.duty * stride_time
    flight = (0.5 - gait.duty) * stride_time
    up = 0.5 * GRAVITY * flight
    aloft = within - stand
    fall = up * aloft - 0.5 * GRAVITY * aloft**2
    dip = -up * stand / pi * np.sin(pi * within / stand)
    return np.asarray(np.where(aloft > 0.0, fall, dip))
