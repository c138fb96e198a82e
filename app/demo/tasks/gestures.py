"""Waving and bowing, standing in one place; waving is written for the right hand."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from app.demo.controls import Arm, Controls, bent, mirrored, standing
from app.demo.curves import ease, softened
from app.demo.keys import ArmKey, ArmPose, arm_through
from app.demo.performance import Performance
from app.demo.posing import within_reach
from app.demo.rig import LEFT, RIGHT
from app.demo.take import Take
from app.numerics.arrays import FloatArray


def wave(take: Take) -> Performance:
    """One hand up, waved from side to side, down again; 4 to 5 s."""
    begin, slow = 0.45 * take.vary(0.5), 1.0 / take.pace
    up = begin + 0.6 * slow
    down = up + 2.3 * take.vary(0.15)
    times = take.clock(down + 0.7 * slow + 0.5 * take.vary(0.5))
    controls = standing(take.actor, take.rig, len(times))
    weight = ease((times - begin) / (0.7 * slow)) - ease((times - down) / (0.7 * slow))
    controls = _leaning(controls, take, weight)
    arm = _waving_arm(times, controls.arms[RIGHT], take, (begin, up, down, down + 0.65 * slow))
    controls = replace(controls, arms=(controls.arms[LEFT], arm))
    controls = within_reach(controls, take.rig, times)
    if take.actor.left_handed:
        controls = mirrored(controls)
    return Performance(times, bent(controls, take.heading, 0.0))


def _waving_arm(
    times: FloatArray, rest: Arm, take: Take, moments: tuple[float, float, float, float]
) -> Arm:
    """The upper arm out and up, the forearm upright and swinging from the elbow."""
    begin, up, down, end = moments
    raised = 1.05 + 0.45 * np.clip(take.size, 0.6, 1.4)
    held = ArmPose(1.4, float(raised), 0.0, 1.5, 0.0)
    keys: list[ArmKey] = [(begin, None), (up, held), (down, held), (end, None)]
    arm = arm_through(times, rest, keys, 0.05)
    strength = ease((times - up + 0.2) / 0.35) - ease((times - down + 0.15) / 0.3)
    rate = 1.75 * take.pace**0.8
    beat = 2.0 * pi * (rate * (times - up) + 0.5 * take.phase)
    swing = 0.42 * take.size * strength
    return replace(
        arm,
        elbow=np.maximum(arm.elbow + swing * np.sin(beat), 0.05),
        twist=arm.twist + 0.25 * swing * np.sin(beat + 0.6),
        abduct=arm.abduct - 0.12 * swing * np.sin(beat - 0.4),
        wrist=arm.wrist + 0.5 * swing * np.sin(beat - 0.9),
    )


def _leaning(controls: Controls, take: Take, weight: FloatArray) -> Controls:
    """Weight onto the other leg, the trunk giving way a little, the head to the greeted one."""
    style = take.actor.style
    shift = 0.025 * style.sway * weight
    root = controls.root + np.stack([shift, -0.2 * shift, 0.0 * shift], axis=-1)
    lean = 0.05 * take.size * weight
    return replace(
        controls,
        root=root,
        pelvis=replace(controls.pelvis, roll=controls.pelvis.roll + 0.6 * lean),
        spine=replace(controls.spine, roll=controls.spine.roll - 1.9 * lean),
        head=replace(
            controls.head,
            roll=controls.head.roll + 1.5 * lean * (1.0 + style.tilt),
            pitch=controls.head.pitch - 0.6 * controls.spine.pitch * weight * 0.4,
        ),
    )


def bow(take: Take) -> Performance:
    """A bow from the hips, held, and up again; 4 to 6 s."""
    slow = 1.0 / take.pace
    begin = 0.45 * take.vary(0.4)
    low = begin + 0.95 * slow
    held = low + 0.55 * slow * take.vary(0.3)
    up = held + 1.1 * slow
    times = take.clock(up + 0.6 * take.vary(0.4))
    controls = standing(take.actor, take.rig, len(times))
    depth = ease((times - begin) / (low - begin)) - ease((times - held) / (up - held))
    lag = softened(depth, times, 0.07)
    controls = _folded(controls, take, depth, lag)
    controls = within_reach(controls, take.rig, times)
    return Performance(times, bent(controls, take.heading, 0.0))


def _folded(controls: Controls, take: Take, depth: FloatArray, lag: FloatArray) -> Controls:
    """Hips fold and go back, spine and neck follow, the arms hang or slide to the thighs."""
    size, leg = np.clip(take.size, 0.75, 1.25), take.rig.leg
    hips, back = 0.72 * size * depth, 0.42 * size * lag
    root = controls.root + np.stack([0.0 * depth, -0.03 * depth, -0.17 * leg * hips], axis=-1)
    # Hanging arms stay about upright in space while the trunk folds, then slide forward.
    drop = hips + back
    arms = [
        replace(
            arm,
            flex=arm.flex + 0.78 * drop,
            elbow=arm.elbow + 0.12 * lag,
            twist=arm.twist + 0.25 * lag,
            abduct=arm.abduct * (1.0 - 0.3 * lag),
        )
        for arm in controls.arms
    ]
    return replace(
        controls,
        root=root,
        pelvis=replace(controls.pelvis, pitch=controls.pelvis.pitch + hips),
        spine=replace(controls.spine, pitch=controls.spine.pitch + back),
        head=replace(controls.head, pitch=controls.head.pitch + 0.3 * lag),
        arms=(arms[0], arms[1]),
    )
