"""Punching from a guard, one fist after the other; written for a right-hander."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians

from app.numerics.arrays import FloatArray
from app.services.demo.controls import Controls, bent, mirrored, standing
from app.services.demo.keys import (
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
from app.services.demo.performance import Performance
from app.services.demo.posing import within_reach
from app.services.demo.rig import LEFT, RIGHT
from app.services.demo.take import Take

COMBINATIONS: tuple[str, ...] = ("jccj", "jcjc", "cjcc")
"""Jabs with the leading and crosses with the rear fist."""


@dataclass(frozen=True, slots=True)
class _Blow:
    """One blow: `fist` side, moments in s."""

    fist: int
    begin: float
    hit: float
    back: float


def punch(take: Take) -> Performance:
    """Four blows out of a guard, 4 to 6 s."""
    blows = _plan(take)
    times = take.clock(blows[-1].back + 0.6 * take.vary(0.3))
    controls = standing(take.actor, take.rig, len(times))
    feet = (
        foot_through(times, controls.feet[LEFT], [(0.0, _leading(take))]),
        foot_through(times, controls.feet[RIGHT], _rear_foot(take, blows)),
    )
    controls = replace(
        controls, feet=feet, root=placed(times, controls.root, _weight(take, blows), 0.04)
    )
    controls = within_reach(_upper_body(times, controls, take, blows), take.rig, times)
    if take.actor.left_handed:
        controls = mirrored(controls)
    return Performance(times, bent(controls, take.heading, 0.0))


def _plan(take: Take) -> list[_Blow]:
    slow = 1.0 / take.pace
    blows, now = [], 0.6 * take.vary(0.3)
    for letter in COMBINATIONS[take.draw.randint(len(COMBINATIONS))]:
        hit = now + 0.19 * slow
        back = hit + 0.34 * slow
        blows.append(_Blow(LEFT if letter == "j" else RIGHT, now, hit, back))
        now = back + 0.32 * slow * take.vary(0.5)
    return blows


def _leading(take: Take) -> FootPose:
    return FootPose(z=0.17 * take.rig.leg, yaw=radians(-12))


def _rear_foot(take: Take, blows: list[_Blow]) -> list[FootKey]:
    """The rear foot turns on its ball and lifts its heel under each cross."""
    rest = FootPose(
        x=-0.04 * take.rig.leg, z=-0.22 * take.rig.leg, pitch=radians(-8), yaw=radians(-28)
    )
    keys: list[FootKey] = [(0.0, rest)]
    for blow in blows:
        if blow.fist == RIGHT:
            raised = replace(rest, pitch=radians(-34))
            keys += [(blow.begin, rest), (blow.hit, raised), (blow.back, rest)]
    return keys


def _weight(take: Take, blows: list[_Blow]) -> list[PlaceKey]:
    """Knees bent; the weight goes into each blow and back."""
    leg, size = take.rig.leg, take.size
    low = -0.045 * leg
    rest = (0.0, low, -0.03 * leg)
    keys: list[PlaceKey] = [(0.0, rest)]
    for blow in blows:
        deep = (0.01 if blow.fist == LEFT else -0.005) * leg
        into = (deep, low - 0.03 * leg * size, (0.07 if blow.fist == RIGHT else 0.05) * leg)
        keys += [(blow.begin, rest), (blow.hit, into), (blow.back, rest)]
    return keys


def _upper_body(
    times: FloatArray, controls: Controls, take: Take, blows: list[_Blow]
) -> Controls:
    style, size = take.actor.style, take.size
    spread = 0.5 * style.arms_out
    guard = ArmPose(0.42, 0.12 + spread, 0.3, 2.15 + 0.15 * style.elbows, 0.0)
    # The fist at the height of the shoulder, whatever the trunk's lean; tired ones punch low.
    level = 1.5 + 0.3 + style.stoop - 0.25 * max(0.0, 1.0 - size)
    hit = ArmPose(level, 0.3 * spread, 0.6, 0.14, 0.0)
    arms: list[list[ArmKey]] = [[(0.0, guard)], [(0.0, guard)]]
    stance = (-0.32, 0.02, 0.0)
    pelvis: list[TurnKey] = [(0.0, stance)]
    spine: list[TurnKey] = [(0.0, (-0.12, 0.14, 0.0))]
    for blow in blows:
        covering = replace(guard, elbow=guard.elbow + 0.1, flex=guard.flex + 0.1)
        for side in (LEFT, RIGHT):
            pose = hit if side == blow.fist else covering
            arms[side] += [(blow.begin, guard), (blow.hit, pose), (blow.hit + 0.03, pose)]
            arms[side] += [(blow.back, guard)]
        turn = (0.55 if blow.fist == RIGHT else -0.18) * style.twist**0.5 * size**0.5
        pelvis += [(blow.begin, stance), (blow.hit, (stance[0] + turn, 0.06, 0.0))]
        pelvis += [(blow.back, stance)]
        spine += [(blow.begin, (-0.12, 0.14, 0.0)), (blow.back, (-0.12, 0.14, 0.0))]
        spine.insert(-1, (blow.hit, (-0.12 + 0.9 * turn, 0.17, 0.0)))
    gaze = [_gaze(p, s) for p, s in zip(_at(pelvis), _at(spine), strict=True)]
    return replace(
        controls,
        pelvis=turned(times, controls.pelvis, pelvis, 0.035),
        spine=turned(times, controls.spine, spine, 0.04),
        head=turned(times, controls.head, gaze, 0.05),
        arms=(
            arm_through(times, controls.arms[LEFT], arms[LEFT], 0.022),
            arm_through(times, controls.arms[RIGHT], arms[RIGHT], 0.022),
        ),
        shrug=controls.shrug + 0.06,
    )


def _at(keys: list[TurnKey]) -> list[TurnKey]:
    return sorted(keys)


def _gaze(pelvis: TurnKey, spine: TurnKey) -> TurnKey:
    """The eyes stay on the opponent whatever the trunk does; the chin a little down."""
    return (pelvis[0], (-(pelvis[1][0] + spine[1][0]), 0.03, 0.0))
