"""Computes joint centers from markers, as the mean of the markers around a joint.

The center of the hips is the mean of the pelvis markers. That of the neck is the mean of C7 and the
clavicle, and that of the head is the mean of the markers of its band. Knee, ankle, elbow and wrist
are the middle of their two markers, or the outer marker alone. The outer marker is up to 5 cm away
from the true center, but always on the same side. By Bell, Pedersen and Brand (1990), a hip joint
is inward, below and behind the front pelvis marker by 14 %, 30 % and 22 % of the distance between
the two front pelvis markers. Without pelvis markers, by Weinhandl and O'Connor (2010), it is a
quarter of the way from one greater trochanter to the other. No model of the person is fitted.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.numerics.arrays import FloatArray

_R = JointRole
Recipe = tuple[str, ...]
"""Places of markers on the body (see `marker_names.py`). Their mean is the center of a joint."""

_SIDED: dict[str, tuple[Recipe, ...]] = {
    "knee": (("?KJC",), ("?KNE", "?KNM"), ("?KNE",)),
    "foot": (("?AJC",), ("?ANK", "?ANM"), ("?ANK",), ("?HEE", "?MFS"), ("?HEE",)),
    "toes": (("?TOE",), ("?MT1", "?MT5"), ("?MT5",)),
    "shoulder": (("?SJC",), ("?SHO",)),
    "elbow": (("?EJC",), ("?ELB", "?ELM"), ("?ELB",)),
    "hand": (("?WJC",), ("?WRA", "?WRB"), ("?WRI",), ("?WRA",), ("?WRB",), ("?FIN",)),
    "upper_leg": (("?HJC",),),
}
_PELVES: tuple[Recipe, ...] = (("LASI", "RASI", "LPSI", "RPSI"), ("LASI", "RASI", "SACR"))
RECIPES: dict[JointRole, tuple[Recipe, ...]] = {
    _R.HIPS: (*_PELVES, ("LHJC", "RHJC"), ("LASI", "RASI"), ("LGTR", "RGTR")),
    _R.CHEST: (("STRN", "T10"), ("CLAV", "T10"), ("STRN",), ("T10",)),
    _R.NECK: (("C7", "CLAV"), ("C7",), ("NECK",), ("LSHO", "RSHO"), ("LSJC", "RSJC")),
    _R.HEAD: (
        ("LFHD", "RFHD", "LBHD", "RBHD"), ("TOPHD", "FRONTHD", "REARHD"), ("FRONTHD", "REARHD"),
        ("LBHD", "RBHD"), ("LFHD", "RFHD"), ("TOPHD",),
    ),
    **{
        JointRole(f"{side}_{part}"): tuple(
            tuple(place.replace("?", side[0].upper()) for place in recipe) for recipe in recipes
        )
        for part, recipes in _SIDED.items()
        for side in ("left", "right")
    },
}  # fmt: skip
"""The recipes of each role, the best one first."""
_TROCHANTERS = ("LGTR", "RGTR")
_INWARD_OF_TROCHANTER = 0.25
"""The way from a greater trochanter to the hip joint, as a share of the way to the other one."""
_INWARD, _DOWN, _BACK = 0.14, 0.30, 0.22
"""The distances of a hip joint from the front pelvis marker, as shares of the pelvis width."""


@dataclass(frozen=True, slots=True)
class Center:
    """The center of a joint, and the places of the markers from which it is computed.

    positions: (frames, 3) float64 in the unit and axes of the markers.
    """

    positions: FloatArray
    places: Recipe


def joint_centers(markers: Mapping[str, FloatArray]) -> dict[JointRole, Center]:
    """The joint centers that can be computed from `markers`, in their unit and axes.

    markers: (frames, 3) for each place on the body.
    """
    found: dict[JointRole, Center] = {}
    for role, recipes in RECIPES.items():
        recipe = best_recipe(recipes, markers.__contains__)
        if recipe is not None:
            found[role] = Center(_mean(markers, recipe), recipe)
    pelvis = best_recipe(_PELVES, markers.__contains__)
    if pelvis is not None:
        _add_hip_joints(found, markers, pelvis)
    elif all(place in markers for place in _TROCHANTERS):
        left, right = (markers[place].astype(np.float64) for place in _TROCHANTERS)
        inward = _INWARD_OF_TROCHANTER * (right - left)
        found.setdefault(_R.LEFT_UPPER_LEG, Center(left + inward, _TROCHANTERS))
        found.setdefault(_R.RIGHT_UPPER_LEG, Center(right - inward, _TROCHANTERS))
    return {role: found[role] for role in JointRole if role in found}


def best_recipe(recipes: tuple[Recipe, ...], has: Callable[[str], bool]) -> Recipe | None:
    """The first recipe for which all markers exist; None if there is none."""
    return next((recipe for recipe in recipes if all(map(has, recipe))), None)


def _add_hip_joints(
    found: dict[JointRole, Center], markers: Mapping[str, FloatArray], pelvis: Recipe
) -> None:
    """Add the hip joints of Bell, Pedersen and Brand (1990), for roles without a center."""
    left, right = markers["LASI"].astype(np.float64), markers["RASI"].astype(np.float64)
    back = _mean(markers, pelvis[2:])
    width = np.linalg.norm(left - right, axis=-1, keepdims=True)
    left_axis = _unit(left - right)
    forward: FloatArray = (left + right) / 2 - back
    # The axes of the pelvis: left, forward at right angles to it, and up.
    forward = _unit(forward - np.sum(forward * left_axis, axis=-1, keepdims=True) * left_axis)
    up = np.cross(forward, left_axis)
    for role, front, side in ((_R.LEFT_UPPER_LEG, left, 1.0), (_R.RIGHT_UPPER_LEG, right, -1.0)):
        inward = -side * _INWARD * left_axis
        center = front + width * (inward - _DOWN * up - _BACK * forward)
        found.setdefault(role, Center(center, pelvis))


def _mean(markers: Mapping[str, FloatArray], recipe: Recipe) -> FloatArray:
    return np.asarray(np.mean([markers[place] for place in recipe], axis=0, dtype=np.float64))


def _unit(vectors: FloatArray) -> FloatArray:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.where(lengths > 0, lengths, 1.0))
