"""Jumping on the spot: crouch, push off, free fall, land and absorb."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import radians, sqrt

import numpy as np

from app.demo.controls import Controls, Foot, along_arc, standing_controls
from app.demo.curves import keyed_curve, quintic_curve
from app.demo.keys import ArmKey, ArmPose, TurnKey
from app.demo.performance import Performance
from app.demo.posing import max_root_height
from app.demo.rig import SIDES
from app.demo.take import GRAVITY, Take
from app.demo.tasks.standing_tasks import Smoothing, UpperBodyKeys, with_upper_body
from app.numerics.arrays import FloatArray

SMOOTHING = Smoothing(pelvis=0.03, spine=0.03, head=0.05, arms=0.03)
ON_TOES = radians(-48)
"""The pitch of the feet when they leave the floor."""
SPARE = 0.03
"""The share of the leg's length by which the legs can still stretch after take-off."""
STRETCH = 0.05
"""Leg lengths by which the feet hang lower in the air than at take-off."""
POINTED = radians(-14)
"""The pitch that is added to feet that hang."""


@dataclass(frozen=True, slots=True)
class Jump:
    """The moments of one jump, s.

    lowest: the deepest crouch. off: take-off. down: landing. absorbed: the deepest crouch after
    it. upright: the actor stands again. speed: of the pelvis at take-off, m/s. forward: the
    length of the jump, m.
    """

    begin: float
    lowest: float
    off: float
    down: float
    absorbed: float
    upright: float
    speed: float
    forward: float


def jump(take: Take) -> Performance:
    """Two jumps with both arms swinging, 4 to 6 s."""
    jumps = _plan(take)
    times = take.clock(jumps[-1].upright + 0.45 * take.vary(0.3))
    controls = standing_controls(take.actor, take.rig, len(times))
    heels = _heel_lift(times, jumps)
    aloft_height = _take_off_height(controls, take)
    height = _height(times, controls, take, jumps, aloft_height)
    controls = with_upper_body(times, controls, _upper_body(take, jumps), SMOOTHING)
    root = controls.root.copy()
    root[:, 1] = height
    root[:, 2] += _forward(times, jumps) + _counterweight(times, take, jumps)
    leg = take.rig.leg
    above = (height - aloft_height) / leg
    feet = [_foot(times, controls.feet[s], jumps, above, heels, leg) for s in SIDES]
    controls = replace(controls, root=root, feet=(feet[0], feet[1]))
    return Performance(times, along_arc(controls, take.heading, 0.0))


def _plan(take: Take) -> list[Jump]:
    rise = 0.27 * take.size**1.3 * take.rig.leg / 0.82
    slow = 1.0 / take.pace
    jumps, now = [], 0.5 * take.vary(0.4)
    for _ in range(2):
        speed = sqrt(2.0 * GRAVITY * rise * take.vary(0.12))
        lowest = now + 0.55 * slow * take.vary(0.1)
        off = lowest + 0.3 * slow**0.3
        down = off + 2.0 * speed / GRAVITY
        absorbed = down + 0.24 * slow**0.3
        upright = absorbed + 0.55 * slow
        forward = float(take.draw.uniform(-0.02, 0.12)) * take.size
        jumps.append(Jump(now, lowest, off, down, absorbed, upright, speed, forward))
        now = upright + 0.25 * slow * take.vary(0.4)
    return jumps


def _take_off_height(controls: Controls, take: Take) -> float:
    """The height of the pelvis, m, with nearly straight legs and the heels up."""
    feet = [replace(foot, pitch=foot.pitch + ON_TOES) for foot in controls.feet]
    reach = np.min(max_root_height(replace(controls, feet=(feet[0], feet[1])), take.rig))
    return float(reach - SPARE * take.rig.leg)


def _height(
    times: FloatArray, controls: Controls, take: Take, jumps: list[Jump], top: float
) -> FloatArray:
    """(frames,) the height of the pelvis, m: quintic curves on the floor, free fall in the air."""
    rest, leg = float(controls.root[0, 1]), take.rig.leg
    states = [(0.0, rest, 0.0, 0.0)]
    for one in jumps:
        deep = rest - (0.26 + 0.1 * take.size) * leg
        states += [
            (one.begin, rest, 0.0, 0.0),
            (one.lowest, deep, 0.0, 2.5 * one.speed),
            (one.off, top, one.speed, -GRAVITY),
            (one.down, top, -one.speed, -GRAVITY),
            (one.absorbed, rest - 0.24 * leg, 0.0, 2.5),
            (one.upright, rest, 0.0, 0.0),
        ]
    states.append((max(float(times[-1]), states[-1][0]) + 1.0, rest, 0.0, 0.0))
    return quintic_curve(times, states)


def _foot(
    times: FloatArray,
    still: Foot,
    jumps: list[Jump],
    above: FloatArray,
    pitch: FloatArray,
    leg: float,
) -> Foot:
    """One foot. Both feet leave and land together, and hang below the pelvis in the air.

    above: (frames,) the height of the pelvis above that at take-off, in leg lengths. The legs
    stretch gradually when the feet leave the floor, so that the feet do not start with a jump.
    """
    aloft = np.zeros(len(times))
    hanging = np.zeros(len(times))
    for one in jumps:
        flying = (times > one.off) & (times < one.down)
        u = np.clip((times - one.off) / (one.down - one.off), 0.0, 1.0)
        high = np.where(flying, np.maximum(above, 0.0), 0.0)
        hang = 1.0 - np.exp(-high / STRETCH)
        aloft += high - STRETCH * hang + 0.03 * np.sin(np.pi * u) ** 4
        hanging += hang
    position = still.position.copy()
    position[:, 1] += aloft * leg
    position[:, 2] += _forward(times, jumps)
    return replace(still, position=position, pitch=still.pitch + pitch + POINTED * hanging)


def _forward(times: FloatArray, jumps: list[Jump]) -> FloatArray:
    """(frames,) the forward position, m: constant speed in the air, no change on the floor."""
    position = np.zeros(len(times))
    for one in jumps:
        position += one.forward * np.clip((times - one.off) / (one.down - one.off), 0.0, 1.0)
    return position


def _heel_lift(times: FloatArray, jumps: list[Jump]) -> FloatArray:
    """(frames,) the pitch of the feet: on the toes at take-off, flat soon after landing."""
    keys = [(0.0, 0.0)]
    for one in jumps:
        push = one.off - one.lowest
        keys += [
            (one.lowest + 0.45 * push, 0.0),
            (one.off, ON_TOES),
            (one.off + 0.45 * (one.down - one.off), 0.75 * ON_TOES),
            (one.down, ON_TOES),
            (one.down + 0.09, 0.0),
        ]
    return keyed_curve(times, keys)


def _counterweight(times: FloatArray, take: Take, jumps: list[Jump]) -> FloatArray:
    """(frames,) z of the pelvis, m: it goes back when the trunk bends forward, for balance."""
    back = -0.1 * take.rig.leg
    keys = [(0.0, 0.0)]
    for one in jumps:
        keys += [(one.begin, 0.0), (one.lowest, 1.3 * back), (one.off, 0.0), (one.down, 0.0)]
        keys += [(one.absorbed, back), (one.upright, 0.0)]
    return keyed_curve(times, keys, 0.02)


def _upper_body(take: Take, jumps: list[Jump]) -> UpperBodyKeys:
    """The trunk bends in each crouch, and both arms swing up at take-off."""
    style = take.actor.style
    swing = style.arm_swing**0.5 * take.size**0.5
    behind = ArmPose(-0.65 * swing, style.arms_out + 0.15, 0.1, 0.35 + 0.3 * style.elbows)
    above = ArmPose(min(2.35 * swing, 2.6), style.arms_out + 0.2, 0.0, 0.5 + 0.5 * style.elbows)
    balance = ArmPose(0.7, style.arms_out + 0.45, 0.2, 0.6 + 0.5 * style.elbows)
    arm: list[ArmKey] = [(0.0, None)]
    pelvis: list[TurnKey] = [(0.0, (0.0, 0.0, 0.0))]
    spine, head = list(pelvis), list(pelvis)
    for one in jumps:
        apex = 0.5 * (one.off + one.down)
        arm += [(one.begin, None), (one.lowest - 0.14, behind), (one.off + 0.02, above)]
        # the arms do not move in the air, so that the hips fall like the center of mass
        arm += [(0.4 * apex + 0.6 * one.down, above), (one.absorbed, balance)]
        arm += [(one.upright + 0.1, None)]
        for keys, size in ((pelvis, 0.5), (spine, 0.42), (head, -0.45)):
            keys += [
                (one.begin, (0.0, 0.0, 0.0)),
                (one.lowest, (0.0, size, 0.0)),
                (one.off, (0.0, -0.04 * size, 0.0)),
                (one.down, (0.0, 0.2 * size, 0.0)),
                (one.absorbed, (0.0, 0.8 * size, 0.0)),
                (one.upright, (0.0, 0.0, 0.0)),
            ]
    return UpperBodyKeys(pelvis, spine, head, (arm, arm))
