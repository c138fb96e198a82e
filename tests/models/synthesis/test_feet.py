from __future__ import annotations

import numpy as np
import pytest

from app.models.synthesis.feet import feet_of, floor_of, on_the_floor, sole_depths
from app.motion.skeleton.animation import Animation
from app.motion.skeleton.rotations import euler_to_quaternions, identity_quaternions
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

RATE = 30.0
FLAT = 0.08
"""Meters from the ankle to the floor."""


def leg(ankles: FloatArray, pitch: FloatArray) -> Animation:
    """Two feet under a root that is the way of the left ankle (n, 3); the right one is still.
    pitch: (n,) radians by which both feet point down."""
    offsets = np.array(
        [[0, 0, 0], [0, 0, 0], [0, -FLAT, 0.16], [0.3, 0, 0], [0, -FLAT, 0.16]], dtype=float
    )
    parents = np.array([-1, 0, 1, 0, 3])
    skeleton = Skeleton(("root", "left", "left toe", "right", "right toe"), parents, offsets)
    n = len(ankles)
    rotations = identity_quaternions((n, 5))
    rotations[:, [1, 3]] = euler_to_quaternions(pitch[:, None], "X")[:, None]
    translations = np.tile(offsets, (n, 1, 1))
    translations[:, 0] = ankles
    translations[:, 3] -= ankles - ankles[0]
    return Animation(skeleton, rotations, translations, RATE)


def rolling(n: int = 60) -> FloatArray:
    """An ankle that stands flat, rolls over the toes, swings one pace on and stands again."""
    way = np.tile([0.0, FLAT, 0.0], (n, 1))
    length = np.hypot(FLAT, 0.16)
    angle = np.arctan2(FLAT, 0.16) + np.linspace(0.0, 0.7, 8)
    way[20:28, 1] = length * np.sin(angle)
    way[20:28, 2] = 0.16 - length * np.cos(angle)
    swing = np.linspace(0.0, 1.0, 12)[:, None]
    end = np.array([0.0, FLAT, 1.0])
    way[28:40] = way[27] + swing * (end - way[27]) + [0, 0.05, 0] * np.sin(np.pi * swing)
    way[40:] = end
    return way


def test_a_foot_lies_flat_where_it_stands_and_its_tip_stays_while_the_heel_rises() -> None:
    pitch = 0.3 + 0.2 * np.sin(np.arange(60) / 3)
    start = leg(rolling(), pitch)
    feet = feet_of(start.skeleton, [1, 3])
    made = on_the_floor(start, feet).positions()
    np.testing.assert_allclose(made[:, [0, 1, 3]], start.positions()[:, [0, 1, 3]], atol=1e-9)
    assert made[:, :, 1].min() >= -1e-9
    np.testing.assert_allclose(made[:, 4, 1], 0.0, atol=1e-6)
    np.testing.assert_allclose(made[:26, 2], [0.0, 0.0, 0.16] * np.ones((26, 1)), atol=0.01)
    np.testing.assert_allclose(made[44:, 2], [0.0, 0.0, 1.16] * np.ones((16, 1)), atol=0.01)
    left, before = (
        positions[34:37, 2] - positions[34:37, 1] for positions in (made, start.positions())
    )
    np.testing.assert_allclose(left, before, atol=0.025)  # it swings as it did


def test_the_floor_is_under_the_standing_ankle_whatever_the_foot_does() -> None:
    real = leg(rolling(), np.zeros(60)).positions()
    feet = feet_of(leg(rolling(), np.zeros(60)).skeleton, [1, 3])
    deep = sole_depths(feet, [real, real + np.array([0.0, 0.4, 0.0])])
    assert deep == pytest.approx([FLAT, FLAT])
    pointing = leg(rolling() + np.array([0.0, 0.25, 0.0]), np.full(60, 0.5)).positions()
    assert floor_of(pointing, feet, deep) == pytest.approx(0.25)
    pointing[:, 0, 1] = 0.1  # something else of the body lies lower
    assert floor_of(pointing, feet, deep) == pytest.approx(0.1)


def test_an_ankle_without_a_foot_stays_as_it_is() -> None:
    assert feet_of(leg(rolling(), np.zeros(60)).skeleton, [1, 4]) == []
