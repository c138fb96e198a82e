"""Dancing on a beat: keyposes struck and held at beats, one foot moved at a time.

The beats and the times of the keyposes are known, so that the results of the analysis can be
compared with them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import pi

import numpy as np

from app.demo.controls import Arm, Controls, Foot, Turn, bent, mirrored, standing
from app.demo.curves import ease
from app.demo.keys import ArmPose, FootPose
from app.demo.performance import Performance
from app.demo.posing import within_reach
from app.demo.rig import LEFT, RIGHT, SIDES
from app.demo.take import Take
from app.numerics.arrays import FloatArray

HOLD = 0.3
"""Share of a beat, around the beat, for which a keypose is held."""
SECONDS = 9.5
RHYTHMS: tuple[tuple[int, ...], ...] = ((1, 1, 2), (1, 1, 1, 1, 2), (2, 1, 1))
"""Beats from one keypose to the next, repeated."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One keypose; lengths in leg lengths, angles in rad.

    shift: (x, down) of the pelvis; hips, trunk: (yaw, pitch, roll); left, right: arms and
    feet; turn: yaw of the head.
    """

    shift: tuple[float, float]
    hips: tuple[float, float, float]
    trunk: tuple[float, float, float]
    arms: tuple[ArmPose, ArmPose]
    feet: tuple[FootPose, FootPose]
    turn: float = 0.0


def _both(pose: ArmPose) -> tuple[ArmPose, ArmPose]:
    return (pose, pose)


_CLAP = ArmPose(1.15, 0.0, 0.75, 1.0)
_OPEN = ArmPose(0.2, 1.5, 0.0, 0.2)
_CROSSED = ArmPose(0.55, -0.1, 0.9, 0.95)
_UP = ArmPose(2.5, 0.25, 0.0, 0.3)
_AKIMBO = ArmPose(-0.5, 0.75, 0.9, 1.75)
_POINT = ArmPose(0.3, 2.25, 0.0, 0.12)
_DOWN = ArmPose(-0.1, 0.65, 0.2, 0.2)
_GOAL = ArmPose(1.5, 1.5, 0.0, 1.5)
_FOLDED = ArmPose(0.35, 0.5, 0.5, 2.1)
_HOME = FootPose()
_TAP = (0.24, 0.35)
"""(z of a heel tap, pitch of the foot)."""


def _foot(x: float, tapping: bool = False) -> FootPose:
    return FootPose(x=x, z=_TAP[0] * tapping, pitch=_TAP[1] * tapping)


FIGURES: tuple[Figure, ...] = (
    Figure((0.0, 0.02), (0.0, 0.0, 0.0), (0.0, 0.06, 0.0), _both(_CLAP), (_HOME, _HOME)),
    Figure(
        (0.13, 0.05), (0.2, 0.0, 0.08), (0.2, 0.0, -0.2), _both(_OPEN), (_foot(0.24), _HOME), 0.4
    ),
    Figure(
        (0.22, 0.11),
        (0.0, 0.1, 0.0),
        (0.0, 0.3, 0.0),
        _both(_CROSSED),
        (_foot(0.24), _foot(0.22)),
    ),
    Figure(
        (0.17, 0.05),
        (-0.25, -0.05, -0.08),
        (-0.25, -0.1, 0.1),
        (_AKIMBO, _UP),
        (_foot(0.24, tapping=True), _foot(0.22)),
        -0.3,
    ),
    Figure(
        (0.24, 0.03),
        (0.1, 0.0, 0.1),
        (0.2, 0.0, 0.18),
        (_POINT, _DOWN),
        (_foot(0.24), _foot(0.22)),
        0.6,
    ),
    Figure((0.11, 0.07), (0.0, 0.0, 0.0), (0.0, -0.1, 0.0), _both(_UP), (_foot(0.24), _HOME)),
    Figure(
        (0.0, 0.14), (0.0, 0.12, 0.0), (0.35, 0.25, 0.1), (_FOLDED, _AKIMBO), (_HOME, _HOME), -0.3
    ),
    Figure(
        (0.07, 0.04),
        (0.25, -0.05, 0.08),
        (0.25, -0.1, -0.1),
        (_UP, _AKIMBO),
        (_HOME, _foot(0.0, tapping=True)),
        0.3,
    ),
    Figure((-0.12, 0.16), (0.0, 0.08, 0.0), (-0.2, 0.1, 0.0), _both(_GOAL), (_HOME, _foot(-0.24))),
)


def dance(take: Take) -> Performance:
    """Keyposes on beats of the actor's own tempo, about 10 s."""
    beat = 60.0 / (take.actor.beats_per_minute * take.vary(0.03))
    first = beat * float(take.draw.uniform(0.7, 1.0))
    times = take.clock(SECONDS * take.vary(0.05))
    beats = np.arange(first, times[-1], beat)
    struck = _struck(take, len(beats))
    start = int(take.draw.randint(len(FIGURES)))
    figures = [FIGURES[(start + k) % len(FIGURES)] for k in range(len(struck) + 1)]
    weights = _weights(times, first + beat * np.array(struck), beat)
    controls = _figured(standing(take.actor, take.rig, len(times)), take, figures, weights)
    controls = within_reach(controls, take.rig, times)
    if take.actor.left_handed:
        controls = mirrored(controls)
    keyposes = tuple(float(first + beat * k) for k in struck)
    return Performance(
        times, bent(controls, take.heading, 0.0), keyposes, tuple(float(b) for b in beats)
    )


def _struck(take: Take, beats: int) -> list[int]:
    """Indices of the beats at which a keypose is struck."""
    rhythm = RHYTHMS[take.draw.randint(len(RHYTHMS))]
    struck, at = [], 0
    while at < beats:
        struck.append(at)
        at += rhythm[len(struck) % len(rhythm)]
    return struck


def _weights(times: FloatArray, struck: FloatArray, beat: float) -> FloatArray:
    """(figures, frames) share of each figure, summing to 1; figure 0 is where it starts.

    A transition takes all that the holds leave, so that slow steps are slow, and nobody
    stands like a statue; it ends half a hold before the beat.
    """
    moves = np.diff(struck, prepend=struck[0] - beat) - HOLD * beat
    ends = struck - 0.5 * HOLD * beat
    done: list[FloatArray] = [np.ones(len(times))]
    done += [ease((times - end) / move + 1.0) for end, move in zip(ends, moves, strict=True)]
    done.append(np.zeros(len(times)))
    return np.array([here - after for here, after in pairwise(done)])


def _figured(
    controls: Controls, take: Take, figures: list[Figure], weights: FloatArray
) -> Controls:
    """The figures in their shares, in the actor's style."""
    style, leg, size = take.actor.style, take.rig.leg, float(np.clip(take.size, 0.7, 1.25))
    moving = 4.0 * np.max(weights * (1.0 - weights), axis=0)
    shift = np.array([figure.shift for figure in figures]).T @ weights
    root = controls.root.copy()
    root[:, 0] += shift[0] * leg
    root[:, 1] -= (shift[1] * (0.6 + 0.4 * size) + 0.02 * style.bounce * moving) * leg
    hips = size * np.array([figure.hips for figure in figures]).T @ weights
    trunk = size * np.array([figure.trunk for figure in figures]).T @ weights
    head = np.array([figure.turn for figure in figures]) @ weights
    sway = style.sway**0.4
    arms = [_arm(controls.arms[s], take, [f.arms[s] for f in figures], weights) for s in SIDES]
    feet = [_feet(controls.feet[s], leg, [f.feet[s] for f in figures], weights) for s in SIDES]
    return replace(
        controls,
        root=root,
        pelvis=_plus(controls.pelvis, hips, (style.twist**0.5, 1.0, sway)),
        spine=_plus(controls.spine, trunk, (style.twist**0.5, 1.0, sway)),
        head=_plus(controls.head, np.stack([head, -0.5 * trunk[1], 0.15 * head]), (1, 1, 1)),
        arms=(arms[LEFT], arms[RIGHT]),
        feet=(feet[LEFT], feet[RIGHT]),
    )


def _plus(turn: Turn, angles: FloatArray, factors: tuple[float, float, float]) -> Turn:
    yaw, pitch, roll = (angle * factor for angle, factor in zip(angles, factors, strict=True))
    return Turn(turn.yaw + yaw, turn.pitch + pitch, turn.roll + roll)


def _arm(rest: Arm, take: Take, poses: list[ArmPose], weights: FloatArray) -> Arm:
    """Arms: large for the energetic, close to the actor's own carriage for the tired."""
    will = float(np.clip(0.6 + 0.4 * take.size, 0.7, 1.04))

    def mix(name: str, limit: float = pi) -> FloatArray:
        ease_at = float(getattr(rest, name)[0])
        wanted = [ease_at + will * (float(getattr(pose, name)) - ease_at) for pose in poses]
        return np.asarray(np.minimum(wanted, limit) @ weights)

    return Arm(mix("flex", 2.9), mix("abduct", 2.6), mix("twist"), mix("elbow"), mix("wrist"))


def _feet(rest: Foot, leg: float, poses: list[FootPose], weights: FloatArray) -> Foot:
    """A foot: lifted while it goes from one place to another, planted else."""
    spots = np.array([[pose.x, 0.0, pose.z] for pose in poses]) * leg
    place = rest.place + weights.T @ spots
    for k in range(len(poses) - 1):
        way = float(np.linalg.norm(spots[k + 1] - spots[k]))
        between = np.minimum(4.0 * weights[k] * weights[k + 1], 1.0)
        place[:, 1] += 0.3 * way * between
    pitch = np.array([pose.pitch for pose in poses]) @ weights
    return replace(rest, place=place, pitch=rest.pitch + pitch)
