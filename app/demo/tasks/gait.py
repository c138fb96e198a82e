"""Walking and running: the feet stand still on the floor, and the body moves over them.

The phase is in strides. The left foot strikes at phase 0, the right foot half a stride later. Usual
step lengths, duty factors and joint angles are from Winter 2009 (walking) and Novacheck 1998, The
biomechanics of running (Gait & Posture 7).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import pi, radians

import numpy as np

from app.demo.controls import Controls, Foot, Turn, along_arc, standing_controls
from app.demo.curves import Key, keyed_curve, periodic_curve, softened
from app.demo.performance import Performance
from app.demo.posing import max_root_height
from app.demo.rig import LEFT, RIGHT, SIDES
from app.demo.take import GRAVITY, Take
from app.numerics.arrays import FloatArray

MAX_GAIT_LEG_EXTENSION = 0.9985
"""The largest distance of hip and ankle in gait, as a share of the leg's length."""


@dataclass(frozen=True, slots=True)
class Gait:
    """One kind of gait; times are in s, lengths in leg lengths, angles in rad.

    stride_time: for an average leg. stride: its length. duty: the share of the stride for which a
    foot stands. ahead: the distance before the hips at which it lands, as a share of the distance
    that the hips move while it stands. pitch: keys over the stride (0: strike, duty: toe-off).
    travel: keys (share of the swing, share of the distance). lift: keys (share of the swing,
    height). elbow: (bend at rest, its swing). swing: amplitude of the arms. lean: of the trunk.
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
    """Walking forward on a slight arc, 4 to 5 s."""
    return _perform(take, WALK, seconds=4.6 * take.vary(0.12))


def run(take: Take) -> Performance:
    """Running forward with a flight phase between the steps, 3 to 4 s."""
    return _perform(take, RUN, seconds=3.4 * take.vary(0.12))


def _perform(take: Take, gait: Gait, seconds: float) -> Performance:
    times, style, rig = take.clock(seconds), take.actor.style, take.rig
    # by Froude's law, the time of a stride grows with the square root of the leg's length
    stride_time = gait.stride_time * np.sqrt(rig.leg / 0.85) / take.pace**0.6
    stride = gait.stride * rig.leg * style.step * take.size**0.35
    phase = take.phase + times / stride_time
    still = standing_controls(take.actor, rig, len(times))
    feet = [_foot(take, gait, still.feet[s], times, phase + 0.5 * s, s, stride) for s in SIDES]
    controls = replace(still, feet=(feet[LEFT], feet[RIGHT]))
    controls = _trunk(controls, take, gait, phase)
    controls = _arms(controls, take, gait, phase)
    controls = _with_root(controls, take, gait, phase, stride, stride_time)
    curvature = float(take.draw.uniform(-0.06, 0.06))
    return Performance(times, along_arc(controls, take.heading, curvature))


def _foot(
    take: Take,
    gait: Gait,
    still: Foot,
    times: FloatArray,
    phase: FloatArray,
    side: int,
    stride: float,
) -> Foot:
    """A foot that stands still for the share `duty` of each stride and then swings forward."""
    style = take.actor.style
    count, within = np.divmod(phase, 1.0)
    swing = np.clip((within - gait.duty) / (1.0 - gait.duty), 0.0, 1.0)
    landing = (count - 0.5 * side + gait.ahead * gait.duty) * stride
    position = still.position.copy()
    position[:, 0] *= _narrowing(gait)
    # running lifts the feet high already, so the style may change the height only a little
    eager = (style.knee_lift * take.size) ** (0.7 if gait is WALK else 0.3)
    position[:, 1] = keyed_curve(swing, gait.lift) * take.rig.leg * eager
    position[:, 2] = landing + stride * keyed_curve(swing, gait.travel)
    pitch = periodic_curve(within, gait.pitch) * (0.55 + 0.45 * min(style.energy, 1.1))
    pitch = softened(pitch, times, 0.015)
    return Foot(position=position, pitch=pitch, yaw=still.yaw * (0.8 if gait is WALK else 0.4))


def _narrowing(gait: Gait) -> float:
    """The distance of the feet from the middle line, as a share of that in standing."""
    return 0.6 if gait is WALK else 0.3


def _trunk(controls: Controls, take: Take, gait: Gait, phase: FloatArray) -> Controls:
    """Pelvis and shoulders turn in opposite directions; the head looks forward."""
    style = take.actor.style
    turn = 2.0 * pi * (phase if gait is WALK else phase + 0.08)
    # when the left foot strikes (phase 0), the left hip is in front: the pelvis is turned right
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
    """Each arm swings with the leg of the other side. The elbow bends on the way forward."""
    style = take.actor.style
    base, bend = gait.elbow
    # a runner's feet are farthest apart in the air, some time before the strike
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


def _with_root(
    controls: Controls,
    take: Take,
    gait: Gait,
    phase: FloatArray,
    stride: float,
    stride_time: float,
) -> Controls:
    """The pelvis moves forward, sideways over the standing foot, and up and down with each step."""
    style, rig = take.actor.style, take.rig
    over = (gait.duty * 0.5, 0.02 * style.sway * (1.0 if gait is WALK else 0.4))
    root = controls.root.copy()
    root[:, 0] += over[1] * np.cos(2.0 * pi * (phase - over[0]))
    root[:, 2] += phase * stride + 0.004 * np.sin(4.0 * pi * (phase - 0.1)) * stride
    if gait is WALK:
        root[:, 1] = _walking_height(phase, gait) * style.bounce * rig.leg
    else:
        root[:, 1] = _running_height(phase, gait, stride_time)
    trial = replace(controls, root=root)
    room = np.min(max_root_height(trial, rig, MAX_GAIT_LEG_EXTENSION) - root[:, 1])
    low = np.min(rig.standing_height - 0.6 * style.crouch * rig.leg - np.max(root[:, 1]))
    # a margin, because the small sway that is added later must not stretch a leg too far
    root[:, 1] += min(room - 0.004 * rig.leg, low)
    return replace(controls, root=root)


def _walking_height(phase: FloatArray, gait: Gait) -> FloatArray:
    """(frames,) the height in walking, in leg lengths: highest in the middle of each stance.

    The range is about 4 cm.
    """
    return np.asarray(0.024 * np.cos(4.0 * pi * (phase - 0.5 * gait.duty)))


def _running_height(phase: FloatArray, gait: Gait, stride_time: float) -> FloatArray:
    """(frames,) the height in running, m: free fall in the air, a sine while a foot stands."""
    within = np.mod(phase, 0.5) * stride_time
    stand = gait.duty * stride_time
    flight = (0.5 - gait.duty) * stride_time
    up = 0.5 * GRAVITY * flight
    aloft = within - stand
    fall = up * aloft - 0.5 * GRAVITY * aloft**2
    dip = -up * stand / pi * np.sin(pi * within / stand)
    return np.asarray(np.where(aloft > 0.0, fall, dip))
