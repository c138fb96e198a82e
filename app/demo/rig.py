"""The skeleton of the demo actors: 22 joints and 5 end sites. Meters, Y up, it faces Z, X is left.

The lengths of body segments are the shares of stature by Drillis & Contini (in Winter 2009,
Biomechanics and Motor Control of Human Movement, fig. 4.1), slightly rounded.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from app.demo.actors import Actor, Naming
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

LEFT, RIGHT = 0, 1
SIDES: tuple[int, int] = (LEFT, RIGHT)
SIGNS: tuple[float, float] = (1.0, -1.0)
"""The sign of X on each side."""

HIPS, SPINE, SPINE1, SPINE2, NECK, HEAD = 0, 1, 2, 3, 4, 5
CLAVICLE, UPPER_ARM, FOREARM, HAND = (6, 10), (7, 11), (8, 12), (9, 13)
THIGH, SHIN, FOOT, TOES = (14, 18), (15, 19), (16, 20), (17, 21)
PARENTS = (-1, 0, 1, 2, 3, 4, 3, 6, 7, 8, 3, 10, 11, 12, 0, 14, 15, 16, 0, 18, 19, 20)


@dataclass(frozen=True, slots=True)
class Rig:
    """The skeleton of an actor, and the lengths that posing needs. All lengths are in meters.

    offsets: (22, 3) from parent to joint in the rest pose. ends: (5, 3) the end sites of head,
    hands and toes. arm_drop: the angle of the arms below the horizontal in the rest pose, rad.
    thigh, shin: their lengths. hip_offset: (3,) from the hips to the left thigh. ball: its distance
    before the ankle; heel: its distance behind the ankle. ankle, ball_height: heights of the joints
    of a flat foot. toes: their length.
    """

    offsets: FloatArray
    ends: FloatArray
    arm_drop: float
    thigh: float
    shin: float
    hip_offset: FloatArray
    ankle: float
    ball: float
    ball_height: float
    heel: float
    toes: float

    @property
    def leg(self) -> float:
        """The length of the straight leg from hip joint to ankle, meters."""
        return self.thigh + self.shin

    @property
    def standing_height(self) -> float:
        """The height of the hips (root) above the floor with straight legs, meters."""
        return self.leg + self.ankle - float(self.hip_offset[1])


def build_rig(actor: Actor) -> Rig:
    """The rig of an actor's body."""
    body, unit = actor.body, actor.body.stature
    # longer legs make a shorter trunk, so that the stature stays the same
    trunk = unit * (2.0 - body.legs)
    thigh, shin = 0.245 * unit * body.legs, 0.246 * unit * body.legs
    ankle, ball, ball_height = 0.042 * unit, 0.08 * unit, 0.014 * unit
    hip = np.array([0.052 * unit * body.hips, -0.03 * unit, 0.0])
    offsets = np.zeros((len(PARENTS), 3))
    offsets[SPINE] = [0.0, 0.05 * trunk, -0.005 * unit]
    offsets[SPINE1] = [0.0, 0.062 * trunk, -0.004 * unit]
    offsets[SPINE2] = [0.0, 0.07 * trunk, 0.0]
    offsets[NECK] = [0.0, 0.095 * trunk, 0.004 * unit]
    offsets[HEAD] = [0.0, 0.05 * unit, 0.012 * unit]
    for side in SIDES:
        sign = SIGNS[side]
        arm = np.array([sign * cos(actor.rest_arm_drop), -sin(actor.rest_arm_drop), 0.0])
        offsets[CLAVICLE[side]] = [sign * 0.018 * unit, 0.072 * trunk, 0.01 * unit]
        offsets[UPPER_ARM[side]] = [sign * 0.092 * unit * body.shoulders, 0.0, -0.012 * unit]
        offsets[FOREARM[side]] = 0.172 * unit * body.arms * arm
        offsets[HAND[side]] = 0.15 * unit * body.arms * arm
        offsets[THIGH[side]] = hip * [sign, 1.0, 1.0]
        offsets[SHIN[side]] = [0.0, -thigh, 0.0]
        offsets[FOOT[side]] = [0.0, -shin, 0.0]
        offsets[TOES[side]] = [0.0, ball_height - ankle, ball]
    return Rig(
        offsets=offsets,
        ends=_ends(offsets, unit),
        arm_drop=actor.rest_arm_drop,
        thigh=thigh,
        shin=shin,
        hip_offset=hip,
        ankle=ankle,
        ball=ball,
        ball_height=ball_height,
        heel=0.035 * unit,
        toes=0.04 * unit,
    )


def _ends(offsets: FloatArray, unit: float) -> FloatArray:
    """(5, 3) the end sites: top of the head, left and right fingertips, left and right toe tips."""
    hands = [0.55 * offsets[HAND[side]] for side in SIDES]
    toes = [np.array([0.0, 0.0, 0.04 * unit])] * 2
    return np.array([[0.0, 0.105 * unit, 0.0], *hands, *toes])


def skeleton_of(rig: Rig, naming: Naming, units_per_meter: float = 100.0) -> Skeleton:
    """The rig as a skeleton with the joint names of a convention, in centimeters by default."""
    ends = [HEAD, HAND[LEFT], HAND[RIGHT], TOES[LEFT], TOES[RIGHT]]
    return Skeleton(
        names=NAMES[naming],
        parents=np.array(PARENTS, dtype=np.int64),
        offsets=rig.offsets * units_per_meter,
        end_parents=np.array(ends, dtype=np.int64),
        end_offsets=rig.ends * units_per_meter,
    )


def _both_sides(left: str, right: str, limb: tuple[str, ...]) -> tuple[str, ...]:
    return (*(left.format(part) for part in limb), *(right.format(part) for part in limb))


_LIMBS = (
    *_both_sides("Left{}", "Right{}", ("Shoulder", "Arm", "ForeArm", "Hand")),
    *_both_sides("Left{}", "Right{}", ("UpLeg", "Leg", "Foot", "ToeBase")),
)
_MIXAMO_TRUNK = ("Hips", "Spine", "Spine1", "Spine2", "Neck", "Head")

NAMES: dict[Naming, tuple[str, ...]] = {
    Naming.MOTIONBUILDER: ("Hips", "LowerBack", "Spine", "Spine1", "Neck", "Head", *_LIMBS),
    Naming.MIXAMO: tuple("mixamorig:" + name for name in (*_MIXAMO_TRUNK, *_LIMBS)),
    Naming.UNREAL: (
        *("pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"),
        *_both_sides("{}_l", "{}_r", ("clavicle", "upperarm", "lowerarm", "hand")),
        *_both_sides("{}_l", "{}_r", ("thigh", "calf", "foot", "ball")),
    ),
}
"""The 22 joint names of each convention, in the order of the indices above."""
