"""The angles of the joints over time, as gait laboratories take them (Vasilescu 2002, section 6).

Of positions that are low-pass filtered at 6 Hz (`filtered`) each limb gets a frame, and its
orientation relative to the one before it in the chain gives the joint's angles. They are taken
from positions by role, not from a file's rotations: these are missing in some formats, and relative
to a rest pose that each skeleton chooses for itself, so that they do not agree across libraries.

A ball joint has three angles that are smooth wherever limbs go: the swing of its limb from a
resting direction, as a vector along the sphere (two), and the turn of the limb about its length
(one), which is seen from where the next joint bends to. A straight limb does not show it: such
frames are missing, and spanned by a cubic spline as the paper's are.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from app.motion.roles.joint_roles import SUN_ROLES, JointRole
from app.motion.skeleton.occlusion import MAX_GAP, runs
from app.numerics.arrays import BoolArray, FloatArray

CUT_OFF = 6.0
"""Hz, where power is halved."""

PASSES = 2
"""Forward and backward, so that nothing is delayed: a second-order filter becomes a fourth."""

PADDING = 0.75
"""Seconds by which both ends are continued, by point reflection, for the filter to settle."""

MIN_BEND = np.radians(12.0)
"""Of elbow or knee; with less their plane is noise."""

SHORTEST = 1e-3
"""Meters; a limb that short has no direction, and its angles are 0."""

_TINY = 1e-9

_R = JointRole


@dataclass(frozen=True, slots=True)
class _Ball:
    """Hip or shoulder: the limb from `start` to `middle`, that bends on toward `end`.

    rest: direction of the limb whose swing is 0; hinge: of the axis about which the next joint
    bends there when the turn is 0. Both in the trunk's frame (left, up, forward).
    """

    name: str
    start: JointRole
    middle: JointRole
    end: JointRole
    rest: tuple[float, float, float]
    hinge: tuple[float, float, float]


_H, _Q, _S = np.sqrt(0.5), 0.5 * np.sqrt(0.5), np.sqrt(0.75)
_BALLS = (
    _Ball("left_hip", _R.HIPS, _R.LEFT_KNEE, _R.LEFT_FOOT, (0, -1, 0), (1, 0, 0)),
    _Ball("right_hip", _R.HIPS, _R.RIGHT_KNEE, _R.RIGHT_FOOT, (0, -1, 0), (1, 0, 0)),
    # Arms hang, reach forward and go up, but never point behind the back to the other side.
    # Held forward, their elbows usually bend inward and up.
    _Ball("left_arm", _R.LEFT_SHOULDER, _R.LEFT_ELBOW, _R.LEFT_HAND, (_H, 0, _H), (-_Q, -_S, _Q)),
    _Ball(
        "right_arm", _R.RIGHT_SHOULDER, _R.RIGHT_ELBOW, _R.RIGHT_HAND, (-_H, 0, _H), (-_Q, _S, -_Q)
    ),
)

ANGLES: tuple[str, ...] = (
    "trunk_pitch",
    "trunk_roll",
    "head_pitch",
    "head_roll",
    *(f"{ball.name}_{angle}" for ball in _BALLS for angle in ("flexion", "aside", "turn", "bend")),
)
"""Names of the angles, radians, in their order: 20."""

_UP, _LEFT = np.array([0.0, 1.0, 0.0]), np.array([1.0, 0.0, 0.0])
_RESTS = np.array([ball.rest for ball in _BALLS], dtype=np.float64)[:, None]
_HINGES = np.array([ball.hinge for ball in _BALLS], dtype=np.float64)[:, None]


def joint_angles(positions: FloatArray, rate: float) -> FloatArray:
    """(frames, 20) ANGLES, radians, of the 13 roles' positions (frames, 13, 3), meters, Y up.

    rate: Hz of the frames. Finite for any finite positions; invariant to place, heading and size
    of the body.
    """
    places = np.asarray(positions, dtype=np.float64)
    trunk, heading = _trunk_frame(places), _heading_frame(places)
    spine = _seen_from(heading, _limb(places, (_R.HIPS,), (_R.NECK,)))
    head = _seen_from(trunk, _limb(places, (_R.NECK,), (_R.HEAD,)))
    starts, middles, ends = zip(*((b.start, b.middle, b.end) for b in _BALLS), strict=True)
    upper = _seen_from(trunk, _limb(places, starts, middles))
    lower = _seen_from(trunk, _limb(places, middles, ends))
    balls = _ball_angles(upper, lower, max(1, round(MAX_GAP * rate)))
    swings = [_swing(limb, _UP, _LEFT)[0] for limb in (spine, head)]
    return np.hstack([*swings, *balls])


def filtered(samples: FloatArray, rate: float) -> FloatArray:
    """`samples` (frames, ...) at `rate` Hz through the fourth-order Butterworth of the paper.

    Two passes of the second-order filter, its cut-off raised so that both together halve the
    power at CUT_OFF. A rate that carries no more than that is left alone.
    """
    cut_off = CUT_OFF / (2.0 ** (1.0 / PASSES) - 1.0) ** 0.25
    if cut_off >= rate / 2 or len(samples) < 2:
        return samples
    sections = scipy.signal.butter(2, cut_off, fs=rate, output="sos")
    width = round(PADDING * rate)
    around = [(width, width)] + [(0, 0)] * (samples.ndim - 1)
    padded = np.pad(samples, around, mode="reflect", reflect_type="odd")
    return np.asarray(scipy.signal.sosfiltfilt(sections, padded, axis=0, padlen=0)[width:-width])


def spanned(values: FloatArray, seen: BoolArray, longest: int) -> FloatArray:
    """`values` (frames,) where not `seen` from those that are: by the cubic spline through them
    in gaps of at most `longest` frames, by a straight line in longer ones, in which a spline
    would swing, and by the nearest one at the ends; 0 where nothing was seen."""
    at = np.flatnonzero(seen)
    if not len(at):
        return np.zeros(len(values))
    every = np.arange(len(values))
    filled = np.interp(every, at, values[at])
    short = [
        np.arange(start, stop)
        for start, stop in runs(~seen)
        if start > 0 and stop < len(values) and stop - start <= longest
    ]
    if short and len(at) >= 4:
        gaps = np.concatenate(short)
        filled[gaps] = scipy.interpolate.CubicSpline(at, values[at])(gaps)
    return np.asarray(filled)


def _ball_angles(upper: FloatArray, lower: FloatArray, longest: int) -> FloatArray:
    """(4, n, 4) of each of _BALLS flexion, aside, turn, and the bend of the joint behind it, by
    the directions of both limbs (4, n, 3) in the trunk's frame."""
    axis = np.cross(upper, lower)
    sine, cosine = np.linalg.norm(axis, axis=-1), (upper * lower).sum(axis=-1)
    there = _has_direction(upper) & _has_direction(lower)
    carried = _carried(_HINGES, _RESTS, upper)
    turns = np.arctan2(
        (np.cross(carried, axis) * upper).sum(axis=-1), (carried * axis).sum(axis=-1)
    )
    seen = there & (sine > np.sin(MIN_BEND))
    turns = np.stack([spanned(*each, longest) for each in zip(turns, seen, strict=True)])
    bends = np.arctan2(sine, cosine) * there
    swings = _swing(upper, _RESTS, _HINGES)
    return np.concatenate([swings, turns[..., None], bends[..., None]], axis=-1)


def _swing(limbs: FloatArray, rest: FloatArray, about: FloatArray) -> FloatArray:
    """(k, n, 2) the way along the sphere from `rest` to the directions `limbs` (k, n, 3), radians:
    about an axis orthogonal to it, and toward that axis."""
    ahead = np.cross(about, rest)
    forward, aside = (limbs * ahead).sum(axis=-1), (limbs * about).sum(axis=-1)
    sine = np.hypot(forward, aside)
    angle = np.arctan2(sine, (limbs * rest).sum(axis=-1))
    scale = np.where(sine > _TINY, angle / np.maximum(sine, _TINY), 1.0) * _has_direction(limbs)
    return np.stack([forward * scale, aside * scale], axis=-1)


def _carried(vectors: FloatArray, starts: FloatArray, ends: FloatArray) -> FloatArray:
    """(k, n, 3) `vectors` (k, 1, 3) carried along by the smallest turns from `starts` (k, 1, 3) to
    `ends` (k, n, 3)."""
    axis = np.cross(starts, ends)
    cosine = (ends * starts).sum(axis=-1, keepdims=True)
    share = (axis * vectors).sum(axis=-1, keepdims=True) / np.maximum(1.0 + cosine, _TINY)
    return np.asarray(cosine * vectors + np.cross(axis, vectors) + share * axis)


def _limb(
    positions: FloatArray, starts: Sequence[JointRole], ends: Sequence[JointRole]
) -> FloatArray:
    """(k, n, 3) unit directions from joints to others, 0 where they are in one place."""
    first, last = ([SUN_ROLES.index(role) for role in roles] for roles in (starts, ends))
    line = np.moveaxis(positions[:, last] - positions[:, first], 1, 0)
    length = np.linalg.norm(line, axis=-1, keepdims=True)
    return np.asarray(np.where(length > SHORTEST, line / np.maximum(length, SHORTEST), 0.0))


def _has_direction(limbs: FloatArray) -> BoolArray:
    return np.asarray(np.abs(limbs).max(axis=-1) > 0.0)


def _trunk_frame(positions: FloatArray) -> FloatArray:
    """(n, 3, 3) rows left, up, forward of the trunk: up along the spine."""
    return _frame(_limb(positions, (_R.HIPS,), (_R.NECK,))[0], _left(positions))


def _heading_frame(positions: FloatArray) -> FloatArray:
    """(n, 3, 3) rows left, up, forward with up along the world's Y."""
    return _frame(np.broadcast_to(_UP, (len(positions), 3)), _left(positions))


def _left(positions: FloatArray) -> FloatArray:
    """(n, 3) the shoulders' line; the knees' where there is no shoulder."""
    right, left = (_R.RIGHT_SHOULDER, _R.RIGHT_KNEE), (_R.LEFT_SHOULDER, _R.LEFT_KNEE)
    shoulders, knees = _limb(positions, right, left)
    return np.asarray(np.where(_has_direction(shoulders)[:, None], shoulders, knees))


def _frame(up: FloatArray, left: FloatArray) -> FloatArray:
    forward = _unit(np.cross(left, up), np.array([0.0, 0.0, 1.0]))
    return np.stack([_unit(np.cross(up, forward), _LEFT), up, forward], axis=1)


def _unit(vectors: FloatArray, otherwise: FloatArray) -> FloatArray:
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.asarray(np.where(length > _TINY, vectors / np.maximum(length, _TINY), otherwise))


def _seen_from(frame: FloatArray, directions: FloatArray) -> FloatArray:
    """(k, n, 3) `directions` (k, n, 3) in the coordinates of `frame` (n, 3, 3)."""
    return np.asarray(np.einsum("nij,knj->kni", frame, directions))
