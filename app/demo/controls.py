"""What a performer does, as curves: the pelvis, spine, head, arms and planted feet.

All arrays are (frames,) unless said; radians and meters; the performer faces Z, left is X.
Left and right stand in pairs `(left, right)`, so that a left-hander is a mirror away.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.demo.actors import Actor
from app.demo.rig import SIDES, SIGNS, Rig
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Arm:
    """One arm, from hanging straight down.

    flex: forward and up; abduct: out to the side; twist: inwards about its own axis;
    elbow: bend, never negative; wrist: bend toward the palm's side of the elbow's hinge.
    """

    flex: FloatArray
    abduct: FloatArray
    twist: FloatArray
    elbow: FloatArray
    wrist: FloatArray


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot on or above the ground.

    place: (frames, 3) of the point of the sole below the ankle when flat, y = clearance of
    the lowest point of the sole; pitch: toes up positive (turns about the heel), heel up
    negative (turns about the ball, which stays where it is); yaw: outwards to the left.
    """

    place: FloatArray
    pitch: FloatArray
    yaw: FloatArray


@dataclass(frozen=True, slots=True)
class Turn:
    """Rotation of a part against its parent: yaw to the left, pitch forward, roll to the right."""

    yaw: FloatArray
    pitch: FloatArray
    roll: FloatArray


@dataclass(frozen=True, slots=True)
class Controls:
    """All curves of one performance; `root` (frames, 3) is the pelvis in the world, meters."""

    root: FloatArray
    pelvis: Turn
    spine: Turn
    head: Turn
    arms: tuple[Arm, Arm]
    feet: tuple[Foot, Foot]
    shrug: FloatArray

    @property
    def frames(self) -> int:
        """Number of frames."""
        return int(self.root.shape[0])


def standing(actor: Actor, rig: Rig, frames: int) -> Controls:
    """The actor at ease: their own posture, feet apart, arms hanging."""
    style = actor.style
    zero = np.zeros(frames)
    arm = Arm(
        flex=zero + 0.25 * style.elbows - 0.5 * style.stoop,
        abduct=zero + style.arms_out,
        twist=zero + 0.25,
        elbow=zero + style.elbows,
        wrist=zero + 0.1,
    )
    feet = [
        Foot(
            place=np.tile([SIGNS[s] * style.stance * rig.leg, 0.0, 0.0], (frames, 1)),
            pitch=zero,
            yaw=zero + SIGNS[s] * style.turnout,
        )
        for s in SIDES
    ]
    height = rig.standing - style.crouch * rig.leg
    return Controls(
        root=np.tile([0.0, height, -0.1 * style.stoop * rig.leg], (frames, 1)),
        pelvis=Turn(zero, zero + 0.2 * style.stoop, zero),
        spine=Turn(zero, zero + 0.8 * style.stoop, zero + style.lean),
        head=Turn(zero, zero + style.head - 0.75 * style.stoop, zero + style.tilt - style.lean),
        arms=(arm, arm),
        feet=(feet[0], feet[1]),
        shrug=zero + style.shoulder_lift,
    )


def mirrored(controls: Controls) -> Controls:
    """The same performance with left and right exchanged."""
    flip = np.array([-1.0, 1.0, 1.0])
    return replace(
        controls,
        root=controls.root * flip,
        pelvis=_mirrored_turn(controls.pelvis),
        spine=_mirrored_turn(controls.spine),
        head=_mirrored_turn(controls.head),
        arms=(controls.arms[1], controls.arms[0]),
        feet=(_mirrored_foot(controls.feet[1]), _mirrored_foot(controls.feet[0])),
    )


def _mirrored_turn(turn: Turn) -> Turn:
    return Turn(yaw=-turn.yaw, pitch=turn.pitch, roll=-turn.roll)


def _mirrored_foot(foot: Foot) -> Foot:
    return Foot(place=foot.place * [-1.0, 1.0, 1.0], pitch=foot.pitch, yaw=-foot.yaw)


def bent(controls: Controls, heading: float, curvature: float) -> Controls:
    """The same performance along an arc: `heading` (rad) at the origin, `curvature` (rad / m).

    Straight ahead becomes the arc, so that a foot that stays in place still does.
    """

    def place(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        yaw = heading + curvature * points[:, 2]
        along = np.stack([_arc(points[:, 2], heading, curvature, k) for k in (0, 1)], axis=-1)
        x = along[:, 0] + points[:, 0] * np.cos(yaw)
        z = along[:, 1] - points[:, 0] * np.sin(yaw)
        return np.stack([x, points[:, 1], z], axis=-1), yaw

    root, root_yaw = place(controls.root)
    feet = []
    for foot in controls.feet:
        where, yaw = place(foot.place)
        feet.append(replace(foot, place=where, yaw=foot.yaw + yaw))
    return replace(
        controls,
        root=root,
        pelvis=replace(controls.pelvis, yaw=controls.pelvis.yaw + root_yaw),
        feet=(feet[0], feet[1]),
    )


def _arc(distance: FloatArray, heading: float, curvature: float, axis: int) -> FloatArray:
    """X (axis 0) or Z (axis 1) after `distance` along an arc."""
    turn = np.cos if axis == 0 else np.sin
    if abs(curvature) < 1e-9:
        return np.asarray(distance * (np.sin(heading) if axis == 0 else np.cos(heading)))
    change = turn(heading + curvature * distance) - turn(heading)
    return np.asarray(change * (-1.0 if axis == 0 else 1.0) / curvature)
