"""Punching from a guard, one fist after the other; written for a right-hander."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians

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


def _upper_body(times: FloatArray, controls: Controls, take: Take, blows: list[_Blow]) -> Controls:
    arms = _fists(take, blows)
    pelvis, spine, head = _turning(take, blows)
    return replace(
        controls,
        pelvis=turned(times, controls.pelvis, pelvis, 0.035),
        spine=turned(times, controls.spine, spine, 0.04),
        head=turned(times, controls.head, head, 0.05),
        arms=(
            arm_through(times, controls.arms[LEFT], arms[LEFT], 0.022),
            arm_through(times, controls.arms[RIGHT], arms[RIGHT], 0.022),
        ),
        shrug=controls.shrug + 0.06,
    )


def _fists(take: Take, blows: list[_Blow]) -> tuple[list[ArmKey], list[ArmKey]]:
    """Both fists in the guard; one goes out and back, the other covers meanwhile."""
    style = take.actor.style
    spread = 0.5 * style.arms_out
    guard = ArmPose(0.42, 0.12 + spread, 0.3, 2.15 + 0.15 * style.elbows, 0.0)
    cover = replace(guard, elbow=guard.elbow + 0.1, flex=guard.flex + 0.1)
    # The fist at the height of the shoulder, whatever the trunk's lean; tired ones punch low.
    level = 1.5 + 0.3 + style.stoop - 0.25 * max(0.0, 1.0 - take.size)
    hit = ArmPose(level, 0.3 * spread, 0.6, 0.14, 0.0)
    arms: tuple[list[ArmKey], list[ArmKey]] = ([(0.0, guard)], [(0.0, guard)])
    for blow in blows:
        for side in (LEFT, RIGHT):
            pose = hit if side == blow.fist else cover
            arms[side].append((blow.begin, guard))
            arms[side].extend([(blow.hit, pose), (blow.hit + 0.03, pose), (blow.back, guard)])
    return arms


def _turning(take: Take, blows: list[_Blow]) -> tuple[list[TurnKey], list[TurnKey], list[TurnKey]]:
    """Keys of pelvis, spine and head: the trunk turns into each blow, the eyes stay ahead."""
    will = take.actor.style.twist**0.5 * take.size**0.5
    stance, coiled = (-0.32, 0.02, 0.0), (-0.12, 0.14, 0.0)
    moments: list[tuple[float, float]] = [(0.0, 0.0)]
    for blow in blows:
        turn = (0.55 if blow.fist == RIGHT else -0.18) * will
        moments += [(blow.begin, 0.0), (blow.hit, turn), (blow.back, 0.0)]
    pelvis = [(t, (stance[0] + w, stance[1] + 0.04 * (w != 0.0), 0.0)) for t, w in moments]
    spine = [(t, (coiled[0] + 0.9 * w, coiled[1] + 0.03 * (w != 0.0), 0.0)) for t, w in moments]
    head = [(t, (-(stance[0] + coiled[0] + 1.9 * w), 0.03, 0.0)) for t, w in moments]
    return pelvis, spine, head
