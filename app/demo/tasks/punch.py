"""Punching from a guard, one fist after the other. The left fist is the leading one."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians

from app.demo.keys import ArmKey, ArmPose, FootKey, FootPose, OffsetKey, TurnKey
from app.demo.performance import Performance
from app.demo.rig import LEFT, RIGHT
from app.demo.take import Take
from app.demo.tasks.standing_tasks import BodyKeys, Smoothing, UpperBodyKeys, keyed_performance

SMOOTHING = Smoothing(root=0.04, pelvis=0.035, spine=0.04, head=0.05, arms=0.022)

COMBINATIONS: tuple[str, ...] = ("jccj", "jcjc", "cjcc")
"""j: a jab with the leading fist. c: a cross with the rear fist."""

RAISED_SHOULDERS = 0.06
"""Radians by which the clavicles rise in a guard."""


@dataclass(frozen=True, slots=True)
class _Blow:
    """One blow; fist: its side. begin, hit, back: its moments, s."""

    fist: int
    begin: float
    hit: float
    back: float


def punch(take: Take) -> Performance:
    """Four blows from a guard, 4 to 6 s."""
    blows = _plan(take)
    times = take.clock(blows[-1].back + 0.6 * take.vary(0.3))
    pelvis, spine, head = _trunk_keys(take, blows)
    keys = BodyKeys(
        root=_root_keys(take, blows),
        feet=([(0.0, _leading_foot(take))], _rear_foot_keys(take, blows)),
        upper_body=UpperBodyKeys(pelvis, spine, head, _arm_keys(take, blows), RAISED_SHOULDERS),
    )
    return keyed_performance(take, times, keys, SMOOTHING)


def _plan(take: Take) -> list[_Blow]:
    """The blows of a random combination; a slower actor has longer intervals between them."""
    slow = 1.0 / take.pace
    blows, now = [], 0.6 * take.vary(0.3)
    for letter in COMBINATIONS[take.draw.randint(len(COMBINATIONS))]:
        hit = now + 0.19 * slow
        back = hit + 0.34 * slow
        blows.append(_Blow(LEFT if letter == "j" else RIGHT, now, hit, back))
        now = back + 0.32 * slow * take.vary(0.5)
    return blows


def _leading_foot(take: Take) -> FootPose:
    return FootPose(z=0.17 * take.rig.leg, yaw=radians(-12))


def _rear_foot_keys(take: Take, blows: list[_Blow]) -> list[FootKey]:
    """The rear foot turns on its ball and lifts its heel at each cross."""
    rest = FootPose(
        x=-0.04 * take.rig.leg, z=-0.22 * take.rig.leg, pitch=radians(-8), yaw=radians(-28)
    )
    keys: list[FootKey] = [(0.0, rest)]
    for blow in blows:
        if blow.fist == RIGHT:
            raised = replace(rest, pitch=radians(-34))
            keys += [(blow.begin, rest), (blow.hit, raised), (blow.back, rest)]
    return keys


def _root_keys(take: Take, blows: list[_Blow]) -> list[OffsetKey]:
    """The knees are bent; the pelvis moves forward with each blow and back again."""
    leg, size = take.rig.leg, take.size
    low = -0.045 * leg
    rest = (0.0, low, -0.03 * leg)
    keys: list[OffsetKey] = [(0.0, rest)]
    for blow in blows:
        sideways = (0.01 if blow.fist == LEFT else -0.005) * leg
        forward = (0.07 if blow.fist == RIGHT else 0.05) * leg
        hit = (sideways, low - 0.03 * leg * size, forward)
        keys += [(blow.begin, rest), (blow.hit, hit), (blow.back, rest)]
    return keys


def _arm_keys(take: Take, blows: list[_Blow]) -> tuple[list[ArmKey], list[ArmKey]]:
    """Both fists are in the guard. One goes out and back, while the other one covers the head."""
    style = take.actor.style
    spread = 0.5 * style.arms_out
    guard = ArmPose(0.42, 0.12 + spread, 0.3, 2.15 + 0.15 * style.elbows, 0.0)
    cover = replace(guard, elbow=guard.elbow + 0.1, flex=guard.flex + 0.1)
    # the fist hits at the height of the shoulder for any lean of the trunk, lower if tired
    level = 1.5 + 0.3 + style.stoop - 0.25 * max(0.0, 1.0 - take.size)
    hit = ArmPose(level, 0.3 * spread, 0.6, 0.14, 0.0)
    arms: tuple[list[ArmKey], list[ArmKey]] = ([(0.0, guard)], [(0.0, guard)])
    for blow in blows:
        for side in (LEFT, RIGHT):
            pose = hit if side == blow.fist else cover
            arms[side].append((blow.begin, guard))
            arms[side].extend([(blow.hit, pose), (blow.hit + 0.03, pose), (blow.back, guard)])
    return arms


def _trunk_keys(
    take: Take, blows: list[_Blow]
) -> tuple[list[TurnKey], list[TurnKey], list[TurnKey]]:
    """Keys of pelvis, spine and head: the trunk turns into each blow, the eyes look ahead."""
    strength = take.actor.style.twist**0.5 * take.size**0.5
    stance, coiled = (-0.32, 0.02, 0.0), (-0.12, 0.14, 0.0)
    turns: list[tuple[float, float]] = [(0.0, 0.0)]
    for blow in blows:
        turn = (0.55 if blow.fist == RIGHT else -0.18) * strength
        turns += [(blow.begin, 0.0), (blow.hit, turn), (blow.back, 0.0)]
    pelvis = [(t, (stance[0] + w, stance[1] + 0.04 * (w != 0.0), 0.0)) for t, w in turns]
    spine = [(t, (coiled[0] + 0.9 * w, coiled[1] + 0.03 * (w != 0.0), 0.0)) for t, w in turns]
    # the head turns back by the turn of pelvis and spine together
    head = [(t, (-(stance[0] + coiled[0] + 1.9 * w), 0.03, 0.0)) for t, w in turns]
    return pelvis, spine, head
