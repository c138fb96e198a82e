"""The controls of a performer: curves for the pelvis, spine, head, arms and feet.

Arrays have the shape (frames,) if nothing else is stated. Units are radians and meters. The
performer faces Z, and X is left. Sides are pairs `(left, right)`, so that a performance can be
mirrored for a left-handed actor.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from app.demo.actors import Actor
from app.demo.rig import SIDES, SIGNS, Rig
from app.numerics.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class Arm:
    """One arm. All angles are 0 if it hangs straight down.

    flex: forward and up. abduct: out to the side. twist: inward about the axis of the arm. elbow:
    its bend, never negative. wrist: its bend to the side of the palm.
    """

    flex: FloatArray
    abduct: FloatArray
    twist: FloatArray
    elbow: FloatArray
    wrist: FloatArray


@dataclass(frozen=True, slots=True)
class Foot:
    """One foot on or above the ground.

    position: (frames, 3) x and z of the point of the sole below the ankle if the foot is flat; y is
    the height of the lowest point of the sole. pitch: positive if the toes are up (the foot turns
    about the heel), negative if the heel is up (it turns about the ball, which does not move). yaw:
    to the left.
    """

    position: FloatArray
    pitch: FloatArray
    yaw: FloatArray


@dataclass(frozen=True, slots=True)
class Turn:
    """The rotation of a part relative to its parent: yaw left, pitch forward, roll right."""

    yaw: FloatArray
    pitch: FloatArray
    roll: FloatArray


@dataclass(frozen=True, slots=True)
class Controls:
    """All curves of one performance.

    root: (frames, 3) the position of the pelvis in the world, meters. shrug: the rise of the
    clavicles, radians.
    """

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


def standing_controls(actor: Actor, rig: Rig, frames: int) -> Controls:
    """The actor stands at rest in their own posture, with hanging arms."""
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
            position=np.tile([SIGNS[s] * style.stance * rig.leg, 0.0, 0.0], (frames, 1)),
            pitch=zero,
            yaw=zero + SIGNS[s] * style.turnout,
        )
        for s in SIDES
    ]
    height = rig.standing_height - style.crouch * rig.leg
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
    """`controls` with left and right exchanged."""
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
    return Foot(position=foot.position * [-1.0, 1.0, 1.0], pitch=foot.pitch, yaw=-foot.yaw)


def along_arc(controls: Controls, heading: float, curvature: float) -> Controls:
    """`controls` along an arc, with `heading` (rad) at the origin and `curvature` (rad / m).

    The Z axis is mapped to the arc. Every point with the same (x, z) moves to the same point, so a
    foot that does not move still does not move.
    """

    def mapped(points: FloatArray) -> tuple[FloatArray, FloatArray]:
        yaw = heading + curvature * points[:, 2]
        along = np.stack([_arc(points[:, 2], heading, curvature, k) for k in (0, 1)], axis=-1)
        x = along[:, 0] + points[:, 0] * np.cos(yaw)
        z = along[:, 1] - points[:, 0] * np.sin(yaw)
        return np.stack([x, points[:, 1], z], axis=-1), yaw

    root, root_yaw = mapped(controls.root)
    feet = []
    for foot in controls.feet:
        position, yaw = mapped(foot.position)
        feet.append(replace(foot, position=position, yaw=foot.yaw + yaw))
    return replace(
        controls,
        root=root,
        pelvis=replace(controls.pelvis, yaw=controls.pelvis.yaw + root_yaw),
        feet=(feet[0], feet[1]),
    )


def _arc(distance: FloatArray, heading: float, curvature: float, axis: int) -> FloatArray:
    """(n,) X (axis 0) or Z (axis 1), in meters, after `distance` (n,) meters along an arc."""
    turn = np.cos if axis == 0 else np.sin
    if abs(curvature) < 1e-9:  # a straight line: the formula below would divide by 0
        return np.asarray(distance * (np.sin(heading) if axis == 0 else np.cos(heading)))
    change = turn(heading + curvature * distance) - turn(heading)
    return np.asarray(change * (-1.0 if axis == 0 else 1.0) / curvature)
