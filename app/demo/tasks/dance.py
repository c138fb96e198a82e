"""Dancing to a beat: keyposes are reached and held on beats; one foot moves at a time.

The true times of beats and keyposes are part of the result, so that tests can compare the analysis
with them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import pi

import numpy as np

from app.demo.controls import Arm, Controls, Foot, Turn, standing_controls
from app.demo.curves import ease
from app.demo.keys import ArmPose, FootPose
from app.demo.performance import Performance
from app.demo.rig import LEFT, RIGHT, SIDES
from app.demo.take import Take
from app.demo.tasks.standing_tasks import standing_performance
from app.numerics.arrays import FloatArray

HOLD = 0.3
"""The share of a beat interval for which a keypose is held, centered on its beat."""
SECONDS = 9.5
"""The mean duration."""
RHYTHMS: tuple[tuple[int, ...], ...] = ((1, 1, 2), (1, 1, 1, 1, 2), (2, 1, 1))
"""The numbers of beats from one keypose to the next. Each rhythm is repeated."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One keypose; lengths are in leg lengths, angles in radians.

    shift: of the pelvis, to the left and down. hips, trunk: (yaw, pitch, roll). arms, feet: left
    and right. turn: yaw of the head.
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
"""A heel tap: z of the foot, and its pitch."""


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
    """A dance with keyposes on beats at the tempo of the actor, about 10 s."""
    beat = 60.0 / (take.actor.beats_per_minute * take.vary(0.03))
    first = beat * float(take.draw.uniform(0.7, 1.0))
    times = take.clock(SECONDS * take.vary(0.05))
    beats = np.arange(first, times[-1], beat)
    keypose_beats = _keypose_beats(take, len(beats))
    start = int(take.draw.randint(len(FIGURES)))
    figures = [FIGURES[(start + k) % len(FIGURES)] for k in range(len(keypose_beats) + 1)]
    weights = _weights(times, first + beat * np.array(keypose_beats), beat)
    rest = standing_controls(take.actor, take.rig, len(times))
    return standing_performance(
        take,
        times,
        _with_figures(rest, take, figures, weights),
        keyposes=tuple(float(first + beat * k) for k in keypose_beats),
        beats=tuple(float(b) for b in beats),
    )


def _keypose_beats(take: Take, beats: int) -> list[int]:
    """The indices of the beats that have a keypose."""
    rhythm = RHYTHMS[take.draw.randint(len(RHYTHMS))]
    indices, beat = [], 0
    while beat < beats:
        indices.append(beat)
        beat += rhythm[len(indices) % len(rhythm)]
    return indices


def _weights(times: FloatArray, keyposes: FloatArray, beat: float) -> FloatArray:
    """(figures, frames) the weight of each figure; weights sum to 1. Figure 0 is at the start.

    keyposes: (k,) s. beat: the interval in s. A transition takes all the time between two holds,
    so that slow steps are slow. It ends half a hold before the beat.
    """
    moves = np.diff(keyposes, prepend=keyposes[0] - beat) - HOLD * beat
    ends = keyposes - 0.5 * HOLD * beat
    done: list[FloatArray] = [np.ones(len(times))]
    done += [ease((times - end) / move + 1.0) for end, move in zip(ends, moves, strict=True)]
    done.append(np.zeros(len(times)))
    # a figure has weight from the end of its transition to the end of the next one
    return np.array([here - after for here, after in pairwise(done)])


def _with_figures(
    controls: Controls, take: Take, figures: list[Figure], weights: FloatArray
) -> Controls:
    """`controls` with the weighted sum of the figures, in the style of the actor."""
    style, leg, size = take.actor.style, take.rig.leg, float(np.clip(take.size, 0.7, 1.25))
    # 0 during a hold, 1 in the middle of a transition
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
    """The weighted poses of an arm; a tired actor stays closer to the resting posture."""
    strength = float(np.clip(0.6 + 0.4 * take.size, 0.7, 1.04))

    def mix(name: str, limit: float = pi) -> FloatArray:
        at_rest = float(getattr(rest, name)[0])
        targets = [at_rest + strength * (float(getattr(p, name)) - at_rest) for p in poses]
        return np.asarray(np.minimum(targets, limit) @ weights)

    return Arm(mix("flex", 2.9), mix("abduct", 2.6), mix("twist"), mix("elbow"), mix("wrist"))


def _feet(rest: Foot, leg: float, poses: list[FootPose], weights: FloatArray) -> Foot:
    """The weighted poses of a foot. It is lifted while it moves and stands still otherwise."""
    spots = np.array([[pose.x, 0.0, pose.z] for pose in poses]) * leg
    position = rest.position + weights.T @ spots
    for k in range(len(poses) - 1):
        distance = float(np.linalg.norm(spots[k + 1] - spots[k]))
        between = np.minimum(4.0 * weights[k] * weights[k + 1], 1.0)
        position[:, 1] += 0.3 * distance * between
    pitch = np.array([pose.pitch for pose in poses]) @ weights
    return replace(rest, position=position, pitch=rest.pitch + pitch)
