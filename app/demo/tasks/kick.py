"""Kicking: weight onto one leg, knee up, out, back and down; written for the right leg."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians

import numpy as np

from app.demo.controls import Controls, bent, mirrored, standing
from app.demo.keys import (
    ArmKey,
    ArmPose,
    FootKey,
    FootPose,
    PlaceKey,
    TurnKey,
    arm_through,
    foot_through,
    placed,
    turned,
)
from app.demo.performance import Performance
from app.demo.posing import within_reach
from app.demo.rig import LEFT, RIGHT
from app.demo.take import Take
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class _Moments:
    """One kick's moments, s."""

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
    controls = standing(take.actor, take.rig, len(times))
    controls = replace(
        controls,
        root=placed(times, controls.root, _weight(take, kicks), 0.05),
        feet=(
            controls.feet[LEFT],
            foot_through(times, controls.feet[RIGHT], _foot_keys(take, kicks)),
        ),
    )
    controls = within_reach(_upper_body(times, controls, take, kicks), take.rig, times)
    if take.actor.left_handed:
        controls = mirrored(controls)
    return Performance(times, bent(controls, take.heading, 0.0))


def _plan(take: Take) -> list[_Moments]:
    slow = 1.0 / take.pace
    kicks, now = [], 0.4 * take.vary(0.4)
    for _ in range(2):
        steps = np.cumsum(np.array([0.5, 0.24, 0.17, 0.1, 0.25, 0.5]) * slow * take.vary(0.08))
        kicks.append(_Moments(now, *(now + float(step) for step in steps)))
        now = kicks[-1].down + 0.55 * slow * take.vary(0.3)
    return kicks


def _foot_keys(take: Take, kicks: list[_Moments]) -> list[FootKey]:
    """The kicking foot: heel up behind, folded below the raised knee, out, back, down."""
    rig, leg = take.rig, take.rig.leg
    inward = 0.5 * take.actor.style.stance * leg
    height = np.clip(0.88 * take.size**0.8 * take.actor.style.knee_lift**0.25, 0.4, 1.06)
    rear = FootPose(0.0, 0.0, -0.02 * leg, radians(-38))
    lifted = FootPose(inward, 0.12 * leg, -0.3 * leg, radians(-60))
    knee = FootPose(inward, (0.3 + 0.22 * height) * leg, 0.12 * leg, radians(-20))
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


def _weight(take: Take, kicks: list[_Moments]) -> list[PlaceKey]:
    """The pelvis goes over the standing foot, and back while the leg is out."""
    leg, side = take.rig.leg, 0.88 * take.actor.style.stance * take.rig.leg
    keys: list[PlaceKey] = [(0.0, (0.0, 0.0, 0.0))]
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


def _upper_body(
    times: FloatArray, controls: Controls, take: Take, kicks: list[_Moments]
) -> Controls:
    """Trunk back against the leg, the opposite arm forward, the other one out and back."""
    style, size = take.actor.style, take.size
    out = style.arms_out
    wide = ArmPose(0.75 * size, out + 0.35, 0.3, 0.7 + 0.6 * style.elbows)
    forth = ArmPose(1.0 * size, out + 0.25, 0.4, 0.5 + 0.6 * style.elbows)
    rear = ArmPose(-0.55 * size, out + 0.45, 0.0, 0.45 + 0.6 * style.elbows)
    far: list[ArmKey] = [(0.0, None)]
    near: list[ArmKey] = [(0.0, None)]
    nothing = (0.0, 0.0, 0.0)
    pelvis: list[TurnKey] = [(0.0, nothing)]
    spine: list[TurnKey] = [(0.0, nothing)]
    for one in kicks:
        far += [(one.begin, None), (one.back, wide), (one.out, forth), (one.held, forth)]
        near += [(one.begin, None), (one.back, wide), (one.out, rear), (one.held, rear)]
        far += [(one.folded, wide), (one.down + 0.25, None)]
        near += [(one.folded, wide), (one.down + 0.25, None)]
        pelvis += [
            (one.begin, nothing),
            (one.back, (-0.1, 0.08, 0.02)),
            (one.knee_up, (0.05, -0.16, 0.03)),
            (one.out, (0.3 * style.twist, -0.3 * size, 0.05)),
            (one.folded, (0.1, -0.1, 0.02)),
            (one.down + 0.2, nothing),
        ]
        spine += [
            (one.begin, nothing),
            (one.back, (0.05, 0.08, 0.02)),
            (one.out, (-0.35 * style.twist, 0.1, -0.02)),
            (one.folded, (-0.1, 0.12, 0.0)),
            (one.down + 0.25, nothing),
        ]
    level: list[TurnKey] = [(t, (-0.1 * y, -0.6 * p, 0.0)) for t, (y, p, _) in pelvis]
    return replace(
        controls,
        pelvis=turned(times, controls.pelvis, pelvis, 0.04),
        spine=turned(times, controls.spine, spine, 0.05),
        head=turned(times, controls.head, level, 0.06),
        arms=(
            arm_through(times, controls.arms[LEFT], far, 0.04),
            arm_through(times, controls.arms[RIGHT], near, 0.04),
        ),
    )
