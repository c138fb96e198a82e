"""The actors of the demo library. Each has the same body, style and habits in all tasks.

Lengths are in meters, angles in radians. Factors have no unit; 1 is the average.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from math import radians


class Naming(StrEnum):
    """The convention by which the skeleton of an actor names its joints."""

    MOTIONBUILDER = "motionbuilder"
    MIXAMO = "mixamo"
    UNREAL = "unreal"


@dataclass(frozen=True, slots=True)
class Body:
    """Proportions of a body.

    stature: meters. The others are factors on the proportions of an average body.
    """

    stature: float
    legs: float = 1.0
    arms: float = 1.0
    shoulders: float = 1.0
    hips: float = 1.0


@dataclass(frozen=True, slots=True)
class Style:
    """How a person moves in all tasks.

    tempo, energy: factors on the speed and the size of movements. stoop: forward bend of the
    spine. head: forward bend of the head. arms_out: angle between hanging arms and the trunk.
    elbows: bend of hanging arms. arm_swing, knee_lift, step, bounce, twist: factors on gait and
    gestures. sway: factor on the sideways shift of the weight. turnout: outward turn of the feet.
    stance: half the distance of the feet, as a share of the leg's length. crouch: the share of the
    leg's length by which bent knees lower the pelvis. lean: sideways bend of the trunk.
    shoulder_lift: rise of the clavicles. tilt: sideways bend of the head.
    """

    tempo: float = 1.0
    energy: float = 1.0
    stoop: float = radians(4)
    head: float = radians(4)
    arms_out: float = radians(8)
    elbows: float = radians(14)
    arm_swing: float = 1.0
    knee_lift: float = 1.0
    step: float = 1.0
    bounce: float = 1.0
    twist: float = 1.0
    sway: float = 1.0
    turnout: float = radians(8)
    stance: float = 0.11
    crouch: float = 0.01
    lean: float = 0.0
    shoulder_lift: float = 0.0
    tilt: float = 0.0


@dataclass(frozen=True, slots=True)
class Actor:
    """A person of the demo library, and the properties of their files.

    frame_rate: Hz. beats_per_minute: the tempo of their dances.
    """

    name: str
    body: Body
    style: Style
    left_handed: bool
    frame_rate: float
    naming: Naming
    rest_arm_drop: float
    """Angle of the arms below the horizontal in the rest pose: 0 in a T-pose."""
    beats_per_minute: float


ACTORS: tuple[Actor, ...] = (
    Actor(
        name="ada",
        body=Body(1.68),
        style=Style(tempo=1.08, energy=1.0, stoop=radians(0), head=radians(-2), twist=1.2),
        left_handed=False,
        frame_rate=60.0,
        naming=Naming.MOTIONBUILDER,
        rest_arm_drop=0.0,
        beats_per_minute=98.0,
    ),
    Actor(
        name="bruno",
        body=Body(1.93, legs=1.03, shoulders=1.18, hips=1.1),
        style=Style(
            tempo=0.86,
            energy=0.9,
            stoop=radians(13),
            head=radians(14),
            arms_out=radians(20),
            elbows=radians(24),
            arm_swing=0.65,
            knee_lift=0.8,
            sway=1.9,
            twist=0.6,
            stance=0.16,
            turnout=radians(18),
            crouch=0.02,
        ),
        left_handed=False,
        frame_rate=30.0,
        naming=Naming.MIXAMO,
        rest_arm_drop=0.0,
        beats_per_minute=86.0,
    ),
    Actor(
        name="chika",
        body=Body(1.54, legs=0.97, arms=0.98, shoulders=0.92),
        style=Style(
            tempo=1.2,
            energy=1.25,
            stoop=radians(-5),
            head=radians(-6),
            arms_out=radians(15),
            elbows=radians(42),
            arm_swing=1.3,
            knee_lift=1.7,
            bounce=1.9,
            twist=1.3,
            stance=0.13,
            turnout=radians(4),
        ),
        left_handed=True,
        frame_rate=60.0,
        naming=Naming.UNREAL,
        rest_arm_drop=radians(45),
        beats_per_minute=114.0,
    ),
    Actor(
        name="dele",
        body=Body(1.81, arms=1.04, shoulders=1.1),
        style=Style(
            tempo=1.05,
            energy=1.3,
            stoop=radians(6),
            arms_out=radians(17),
            elbows=radians(32),
            arm_swing=1.1,
            knee_lift=1.2,
            step=1.04,
            twist=1.6,
            stance=0.17,
            turnout=radians(12),
            crouch=0.035,
            shoulder_lift=radians(6),
        ),
        left_handed=False,
        frame_rate=120.0,
        naming=Naming.MOTIONBUILDER,
        rest_arm_drop=radians(45),
        beats_per_minute=104.0,
    ),
    Actor(
        name="elin",
        body=Body(1.61, legs=0.97, shoulders=0.95),
        style=Style(
            tempo=0.8,
            energy=0.68,
            stoop=radians(24),
            head=radians(20),
            arms_out=radians(5),
            elbows=radians(36),
            arm_swing=0.45,
            knee_lift=0.65,
            step=0.78,
            bounce=0.5,
            twist=0.5,
            sway=1.3,
            stance=0.12,
            turnout=radians(15),
            crouch=0.04,
            shoulder_lift=radians(8),
            lean=radians(3),
        ),
        left_handed=False,
        frame_rate=30.0,
        naming=Naming.MIXAMO,
        rest_arm_drop=radians(45),
        beats_per_minute=80.0,
    ),
    Actor(
        name="farid",
        body=Body(1.75, legs=1.02, arms=1.03),
        style=Style(
            tempo=0.95,
            energy=1.1,
            stoop=radians(2),
            head=radians(8),
            arms_out=radians(11),
            elbows=radians(6),
            arm_swing=1.6,
            step=1.05,
            bounce=1.3,
            twist=1.9,
            sway=2.4,
            stance=0.12,
            turnout=radians(20),
            lean=radians(-4),
            tilt=radians(9),
        ),
        left_handed=True,
        frame_rate=60.0,
        naming=Naming.UNREAL,
        rest_arm_drop=0.0,
        beats_per_minute=92.0,
    ),
)
"""Six people. They differ in style more than in size."""
