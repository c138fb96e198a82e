"""Detectors: what a movement must look like to be a turn, a jump, or a moved left hand.

A word model knows the words that its library taught it, by how the clips of that library look. A
detector knows one movement from its definition, with fixed numbers, in any recording: a turn
changes the heading, a run is fast, a dance has many different poses. Each is a probability by
logistic curves of signs of movement (app.analysis.descriptors.movement_signs). They serve

- words of the library, for clips unlike all that it was taught from (app.models.words.calibration),
- words that nobody used, of movements and of parts of the body: *both*, *left ankle*, *knees*.

The source is our own. Thresholds lie between the clips with and without the movement of two of the
sources of the real clips. They are definitions: nothing fits them. Shapes: clips N, detectors C.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from app.analysis.descriptors.movement_signs import SIGNS
from app.models.words.language.inflection import base_forms
from app.models.words.language.lexicon import (
    SAME_MEANING,
    is_kind,
    is_known,
    likeness,
)
from app.numerics.arrays import FloatArray

Signs = Mapping[str, FloatArray]
"""(N,) of each sign, by name."""

CONFIDENCE = 0.8
"""How far a detector is trusted for a word that nobody used."""


@dataclass(frozen=True, slots=True)
class Detected:
    """A detector of a word, and the likeness of its movement to the word, 0..1."""

    name: str
    likeness: float


SIDES = ("left", "right", "both")
LIMBS: dict[str, tuple[str, ...]] = {
    "hand": ("hand",),
    "elbow": ("elbow",),
    "arm": ("hand", "elbow"),
    "foot": ("foot",),
    "knee": ("knee",),
    "leg": ("foot", "knee"),
}
"""The joints whose speeds tell whether a limb moves."""
PLURALS = {"foot": "feet", None: "sides"}
PARTS: dict[str, str] = {
    **dict.fromkeys(("hand", "wrist", "palm", "finger", "fist", "thumb"), "hand"),
    **dict.fromkeys(("foot", "ankle", "heel", "toe", "sole"), "foot"),
    **dict.fromkeys(("knee", "thigh"), "knee"),
    **dict.fromkeys(("leg", "shin", "calf"), "leg"),
    **dict.fromkeys(("arm", "forearm", "shoulder"), "arm"),
    **dict.fromkeys(("head", "face", "chin", "neck"), "head"),
    **dict.fromkeys(("torso", "trunk", "waist", "hip", "back", "chest", "spine"), "trunk"),
    "elbow": "elbow",
}
"""The limb that moves with each part of the body; of the trunk, whether it leans."""
MOVING = {
    "hand": -0.15,
    "elbow": -0.75,
    "foot": -0.6,
    "knee": -0.95,
    "head": -1.6,
}
"""ln(body lengths per second + .1) of a joint that moves as often as not."""


def _above(value: FloatArray, threshold: float, slope: float) -> FloatArray:
    return np.asarray(1.0 / (1.0 + np.exp(np.clip(slope * (threshold - value), -50.0, 50.0))))


def _walking(signs: Signs) -> FloatArray:
    """Cyclic, along the body's own forward axis, and neither at rest nor as fast as a run."""
    is_travel = _above(signs["speed"], -0.3, 6.0) * _above(-signs["speed"], -0.9, 6.0)
    return is_travel * _above(np.abs(signs["forward"]), 0.45, 8.0) * _above(signs["cycle"], 0.8, 8)


def _standing(signs: Signs) -> FloatArray:
    return _above(-signs["foot_speed"], 0.7, 3.0)


def _bending(signs: Signs) -> FloatArray:
    return _above(signs["lean"], 0.25, 25.0) * _standing(signs)


_MOVEMENTS: dict[str, Callable[[Signs], FloatArray]] = {
    "turn": lambda signs: _above(signs["turn"], 0.5, 12.0),
    "jump": lambda signs: _above(signs["rise"], -1.6, 5.0),
    "dance": lambda signs: _above(signs["variety"] + 0.35 * signs["turn_range"], 1.9, 4.0),
    "run": lambda signs: _above(signs["speed"], 0.85, 6.0),
    "walk": _walking,
    "raise": lambda signs: _above(signs["hand_height"], 0.05, 12.0) * _standing(signs),
    "bow": _bending,
    "bend": _bending,
    "kick": lambda signs: _above(signs["foot_height"], 0.55, 8.0),
    "squat": lambda signs: _above(-signs["lowest_hips"], -0.7, 15.0),
}
"""The detectors of movements, by a word of our lexicon."""


def body_detector(part: str | None, side: str | None) -> str:
    """The detector of a part of the body (None: any limb) on a side (None: any)."""
    if part == "trunk":
        return "trunk leans"
    if part == "head":
        return "head moves"
    if side == "both":
        return f"both {PLURALS.get(part, f'{part}s')} move"
    return " ".join(filter(None, (side, part, "moves")))


def _moves(signs: Signs, limb: str, side: str | None) -> FloatArray:
    """Whether a limb moves: on any side; on one, and more than on the other; or on both alike."""
    left, right = (
        np.mean([_joint_moves(signs, joint, one) for joint in LIMBS[limb]], axis=0)
        for one in ("left", "right")
    )
    if side is None:
        return np.asarray(np.maximum(left, right))
    more_left = _more_left(signs, LIMBS[limb][0])
    if side == "both":
        return np.asarray(np.minimum(left, right) * 4.0 * more_left * (1.0 - more_left))
    return np.asarray(left * more_left if side == "left" else right * (1.0 - more_left))


def _joint_moves(signs: Signs, joint: str, side: str) -> FloatArray:
    return _above(signs[f"{side}_{joint}_speed"], MOVING[joint], 3.0)


def _more_left(signs: Signs, joint: str) -> FloatArray:
    """Whether the left joint moves more than the right one; .5 if both move alike."""
    return _above(signs[f"left_{joint}_speed"] - signs[f"right_{joint}_speed"], 0.0, 3.0)


def _side(signs: Signs, side: str) -> FloatArray:
    """The same of the limb that is moved, hand or foot, with the larger difference of its sides."""
    hand, foot = (_more_left(signs, joint) for joint in ("hand", "foot"))
    more_left = np.where(np.abs(hand - 0.5) >= np.abs(foot - 0.5), hand, foot)
    if side == "both":
        return np.asarray(4.0 * more_left * (1.0 - more_left))
    return more_left if side == "left" else np.asarray(1.0 - more_left)


_COLUMNS: dict[str, Callable[[Signs], FloatArray]] = {
    **{f"{word} (measured)": detect for word, detect in _MOVEMENTS.items()},
    "head moves": lambda signs: _above(signs["head_speed"], MOVING["head"], 4.0),
    "trunk leans": lambda signs: _above(signs["lean"], 0.2, 25.0),
    **{
        body_detector(limb, side): partial(_moves, limb=limb, side=side)
        for limb in LIMBS
        for side in (None, *SIDES)
    },
    **{body_detector(None, side): partial(_side, side=side) for side in SIDES},
}
"""All detectors by name. Names have blanks, so that none is a word of a library."""

DETECTORS: tuple[str, ...] = tuple(_COLUMNS)
"""The names of the detectors, in the order of their columns."""


def detect(signs: FloatArray) -> FloatArray:
    """(N, C) probability of each of DETECTORS, for `signs` (N, 44)."""
    named = dict(zip(SIGNS, np.asarray(signs, dtype=np.float64).T, strict=True))
    return np.stack([of(named) for of in _COLUMNS.values()], axis=1)


@cache
def movement_detector(word: str) -> Detected | None:
    """The detector of the movement that a normalized word names, inflected or not."""
    for form in (word, *base_forms(word)):
        if is_known(form):
            near = {one: likeness(form, one) for one in _MOVEMENTS if is_kind(form, one)}
            best = max(near, key=near.__getitem__, default=None)
            return None if best is None else Detected(f"{best} (measured)", near[best])
    return None


def evidence(words: Sequence[str], signs: FloatArray) -> FloatArray:
    """(N, V) probability by the detector of each word, NaN without one; signs: (N, 44).

    A detector is no evidence for a kind of its movement: not every dance is a salsa.
    """
    table = np.full((len(signs), len(words)), np.nan)
    scores = detect(signs)
    for column, word in enumerate(words):
        found = movement_detector(word)
        if found is not None and found.likeness >= SAME_MEANING:
            table[:, column] = scores[:, DETECTORS.index(found.name)]
    return table


def body_part(word: str) -> str | None:
    """The limb, the head or the trunk that a normalized word names, in singular or plural."""
    return next((PARTS[form] for form in (word, *base_forms(word)) if form in PARTS), None)


def body_side(word: str) -> str | None:
    """Left, right or both, if a normalized word says so."""
    return {"two": "both"}.get(word, word if word in SIDES else None)
