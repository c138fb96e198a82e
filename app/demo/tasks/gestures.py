"""Waving with the right hand, and bowing. Both are done on one spot."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np

from app.demo.controls import Arm, Controls, standing_controls
from app.demo.curves import ease, softened
from app.demo.keys import ArmKey, ArmPose, arm_curves
from app.demo.performance import Performance
from app.demo.rig import LEFT, RIGHT
from app.demo.take import Take
from app.demo.tasks.standing_tasks import standing_performance
from app.numerics.arrays import FloatArray


def wave(take: Take) -> Performance:
    """One hand goes up, waves from side to side, and goes down; 4 to 5 s."""
    begin, slow = 0.45 * take.vary(0.5), 1.0 / take.pace
    up = begin + 0.6 * slow
    down = up + 2.3 * take.vary(0.15)
    times = take.clock(down + 0.7 * slow + 0.5 * take.vary(0.5))
    controls = standing_controls(take.actor, take.rig, len(times))
    weight = ease((times - begin) / (0.7 * slow)) - ease((times - down) / (0.7 * slow))
    controls = _with_lean(controls, take, weight)
    arm = _waving_arm(times, controls.arms[RIGHT], take, (begin, up, down, down + 0.65 * slow))
    controls = replace(controls, arms=(controls.arms[LEFT], arm))
    return standing_performance(take, times, controls)


def _waving_arm(
    times: FloatArray, rest: Arm, take: Take, moments: tuple[float, float, float, float]
) -> Arm:
    """The upper arm goes out and up; the upright forearm swings about the elbow."""
    begin, up, down, end = moments
    raised = 1.05 + 0.45 * np.clip(take.size, 0.6, 1.4)
    held = ArmPose(1.4, float(raised), 0.0, 1.5, 0.0)
    keys: list[ArmKey] = [(begin, None), (up, held), (down, held), (end, None)]
    arm = arm_curves(times, rest, keys, 0.05)
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


def _with_lean(controls: Controls, take: Take, weight: FloatArray) -> Controls:
    """The weight shifts to the other leg, the trunk leans, and the head tilts."""
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
    """A bow from the hips, which is held for a moment; 4 to 6 s."""
    slow = 1.0 / take.pace
    begin = 0.45 * take.vary(0.4)
    low = begin + 0.95 * slow
    held = low + 0.55 * slow * take.vary(0.3)
    up = held + 1.1 * slow
    times = take.clock(up + 0.6 * take.vary(0.4))
    controls = standing_controls(take.actor, take.rig, len(times))
    depth = ease((times - begin) / (low - begin)) - ease((times - held) / (up - held))
    lag = softened(depth, times, 0.07)
    controls = _with_bow(controls, take, depth, lag)
    # both sides do the same, and a mirrored bow would also mirror the posture of the actor
    return standing_performance(take, times, controls, is_one_sided=False)


def _with_bow(controls: Controls, take: Take, depth: FloatArray, lag: FloatArray) -> Controls:
    """The hips bend and go back, spine and neck follow, and the arms hang down."""
    size, leg = np.clip(take.size, 0.75, 1.25), take.rig.leg
    hips, back = 0.72 * size * depth, 0.42 * size * lag
    root = controls.root + np.stack([0.0 * depth, -0.03 * depth, -0.17 * leg * hips], axis=-1)
    # arms that hang stay nearly vertical in the world while the trunk bends
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
