"""Kicking with the right leg: the weight shifts, the knee goes up, the foot out and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians

import numpy as np

from app.demo.keys import ArmKey, ArmPose, FootKey, FootPose, OffsetKey, TurnKey
from app.demo.performance import Performance
from app.demo.take import Take
from app.demo.tasks.standing_tasks import BodyKeys, Smoothing, UpperBodyKeys, keyed_performance

SMOOTHING = Smoothing(root=0.05, pelvis=0.04, spine=0.05, head=0.06, arms=0.04)


@dataclass(frozen=True, slots=True)
class _Kick:
    """The moments of one kick, s.

    begin: the weight starts to shift. back: the foot is lifted behind. knee_up: the knee is
    raised. out: the leg is stretched. held: it is still stretched. folded: it is bent again. down:
    the foot is on the ground.
    """

    begin: float
    back: float
    knee_up: float
    out: float
    held: float
    folded: float
    down: float


def kick(take: Take) -> Performance:
    """Two front kicks with the stronger leg, 4 to 6 s."""
    kicks = _plan(take)
    times = take.clock(kicks[-1].down + 0.7 * take.vary(0.3))
    keys = BodyKeys(
        root=_root_keys(take, kicks),
        feet=([(0.0, FootPose())], _foot_keys(take, kicks)),
        upper_body=_upper_body(take, kicks),
    )
    return keyed_performance(take, times, keys, SMOOTHING)


def _plan(take: Take) -> list[_Kick]:
    """The moments of both kicks; a slower actor has longer intervals between them."""
    slow = 1.0 / take.pace
    kicks, now = [], 0.4 * take.vary(0.4)
    for _ in range(2):
        steps = np.cumsum(np.array([0.5, 0.24, 0.17, 0.1, 0.25, 0.5]) * slow * take.vary(0.08))
        kicks.append(_Kick(now, *(now + float(step) for step in steps)))
        now = kicks[-1].down + 0.55 * slow * take.vary(0.3)
    return kicks


def _foot_keys(take: Take, kicks: list[_Kick]) -> list[FootKey]:
    """The kicking foot: heel up behind, folded below the raised knee, out, back, down."""
    rig, leg = take.rig, take.rig.leg
    inward = 0.5 * take.actor.style.stance * leg
    height = np.clip(0.88 * take.size**0.8 * take.actor.style.knee_lift**0.25, 0.4, 1.06)
    rear = FootPose(0.0, 0.0, -0.02 * leg, radians(-38))
    lifted = FootPose(inward, 0.12 * leg, -0.3 * leg, radians(-60))
    knee = FootPose(inward, (0.3 + 0.22 * height) * leg, 0.12 * leg, radians(-20))
    # the hip is one leg length high: by Pythagoras, a leg of length 0.96 reaches this far forward
    reach = float(np.sqrt(max(0.96**2 - (1.0 - height) ** 2, 0.3)))
    out = FootPose(inward, height * leg - rig.ankle, (reach + 0.05) * leg, radians(22))
    keys: list[FootKey] = [(0.0, FootPose())]
    for one in kicks:
        keys += [
            (one.begin + 0.12, FootPose()),
            (one.back - 0.15, rear),
            (one.back, lifted),
            (one.knee_up, knee),
            (one.out, out),
            (one.held, replace(out, z=out.z - 0.03 * leg)),
            (one.folded, replace(knee, z=0.16 * leg)),
            (one.down - 0.08, FootPose(0.0, 0.015, 0.0, radians(-6))),
            (one.down, FootPose()),
        ]
    return keys


def _root_keys(take: Take, kicks: list[_Kick]) -> list[OffsetKey]:
    """The pelvis moves over the standing foot, and backward while the leg is out."""
    leg, side = take.rig.leg, 0.88 * take.actor.style.stance * take.rig.leg
    keys: list[OffsetKey] = [(0.0, (0.0, 0.0, 0.0))]
    for one in kicks:
        keys += [
            (one.begin, (0.0, 0.0, 0.0)),
            (one.back - 0.08, (side, -0.025 * leg, 0.01)),
            (one.knee_up, (side, -0.015 * leg, 0.02)),
            (one.out, (side, -0.01 * leg, 0.035 * leg)),
            (one.folded, (side, -0.025 * leg, -0.01)),
            (one.down, (0.6 * side, -0.03 * leg, 0.0)),
            (one.down + 0.3, (0.0, 0.0, 0.0)),
        ]
    return keys


def _upper_body(take: Take, kicks: list[_Kick]) -> UpperBodyKeys:
    """The trunk leans back against the leg, the opposite arm goes forward, the other one back."""
    pelvis, spine = _trunk_keys(take, kicks)
    # the head turns against the pelvis, so that the eyes stay on the target
    head: list[TurnKey] = [
        (time, (-0.1 * yaw, -0.6 * pitch, 0.0)) for time, (yaw, pitch, _) in pelvis
    ]
    return UpperBodyKeys(pelvis, spine, head, _arm_keys(take, kicks))


def _trunk_keys(take: Take, kicks: list[_Kick]) -> tuple[list[TurnKey], list[TurnKey]]:
    """Keys of the pelvis and of the spine."""
    style, size = take.actor.style, take.size
    rest = (0.0, 0.0, 0.0)
    pelvis: list[TurnKey] = [(0.0, rest)]
    spine: list[TurnKey] = [(0.0, rest)]
    for one in kicks:
        pelvis += [
            (one.begin, rest),
            (one.back, (-0.1, 0.08, 0.02)),
            (one.knee_up, (0.05, -0.16, 0.03)),
            (one.out, (0.3 * style.twist, -0.3 * size, 0.05)),
            (one.folded, (0.1, -0.1, 0.02)),
            (one.down + 0.2, rest),
        ]
        spine += [
            (one.begin, rest),
            (one.back, (0.05, 0.08, 0.02)),
            (one.out, (-0.35 * style.twist, 0.1, -0.02)),
            (one.folded, (-0.1, 0.12, 0.0)),
            (one.down + 0.25, rest),
        ]
    return pelvis, spine


def _arm_keys(take: Take, kicks: list[_Kick]) -> tuple[list[ArmKey], list[ArmKey]]:
    """Keys of the left arm, which goes forward with the kick, and of the right arm."""
    style, size = take.actor.style, take.size
    outward = style.arms_out
    wide = ArmPose(0.75 * size, outward + 0.35, 0.3, 0.7 + 0.6 * style.elbows)
    forward = ArmPose(1.0 * size, outward + 0.25, 0.4, 0.5 + 0.6 * style.elbows)
    rear = ArmPose(-0.55 * size, outward + 0.45, 0.0, 0.45 + 0.6 * style.elbows)
    left: list[ArmKey] = [(0.0, None)]
    right: list[ArmKey] = [(0.0, None)]
    for one in kicks:
        for keys, pose in ((left, forward), (right, rear)):
            keys += [(one.begin, None), (one.back, wide), (one.out, pose), (one.held, pose)]
            keys += [(one.folded, wide), (one.down + 0.25, None)]
    return left, right
