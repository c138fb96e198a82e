"""Rotations agree with the matrices of a textbook, for all orders of axes."""

from __future__ import annotations

from itertools import permutations

import numpy as np
import pytest

from app.motion.skeleton.rotations import (
    euler_to_quaternions,
    matrices_to_quaternions,
    multiply,
    quaternions_to_euler,
    quaternions_to_matrices,
    rotate,
)
from app.numerics.arrays import FloatArray

ORDERS = ["".join(order) for order in permutations("XYZ")]


def textbook(axis: str, angle: float) -> FloatArray:
    c, s = np.cos(angle), np.sin(angle)
    rows = {
        "X": [[1, 0, 0], [0, c, -s], [0, s, c]],
        "Y": [[c, 0, s], [0, 1, 0], [-s, 0, c]],
        "Z": [[c, -s, 0], [s, c, 0], [0, 0, 1]],
    }
    return np.array(rows[axis])


@pytest.mark.parametrize("order", [*ORDERS, "ZXZ", "Y", "ZZ", ""])
def test_euler_angles_turn_in_the_given_order(order: str) -> None:
    angles = np.random.default_rng(0).uniform(-3, 3, (20, len(order)))
    expected = []
    for row in angles:
        matrix = np.eye(3)
        for axis, angle in zip(order, row, strict=True):
            matrix = matrix @ textbook(axis, angle)
        expected.append(matrix)
    found = quaternions_to_matrices(euler_to_quaternions(angles, order))
    assert np.allclose(found, expected, atol=1e-12)


@pytest.mark.parametrize("order", ORDERS)
def test_euler_angles_are_recovered(order: str) -> None:
    angles = np.random.default_rng(1).uniform(-1, 1, (50, 3)) * [3.1, 1.5, 3.1]
    found = quaternions_to_euler(euler_to_quaternions(angles, order), order)
    assert np.allclose(found, angles, atol=1e-6)


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("middle", [np.pi / 2, -np.pi / 2])
def test_the_rotation_is_exact_in_gimbal_lock(order: str, middle: float) -> None:
    angles = np.array([[0.4, middle, -1.1], [2.0, middle, 0.3]])
    turned = euler_to_quaternions(angles, order)
    again = euler_to_quaternions(quaternions_to_euler(turned, order), order)
    assert np.allclose(quaternions_to_matrices(again), quaternions_to_matrices(turned), atol=1e-6)


def test_matrices_and_products_agree() -> None:
    rng = np.random.default_rng(2)
    a, b = (euler_to_quaternions(rng.uniform(-3, 3, (30, 3)), "XYZ") for _ in range(2))
    v = rng.normal(size=(30, 3))
    product = quaternions_to_matrices(a) @ quaternions_to_matrices(b)
    assert np.allclose(quaternions_to_matrices(multiply(a, b)), product)
    assert np.allclose(rotate(a, v), np.einsum("nij,nj->ni", quaternions_to_matrices(a), v))


def test_quaternions_are_recovered_from_matrices_also_for_half_turns() -> None:
    rng = np.random.default_rng(3)
    half_turns = np.eye(4)[1:]
    some = np.concatenate([rng.normal(size=(100, 4)), half_turns, np.eye(4)[:1]])
    some /= np.linalg.norm(some, axis=1, keepdims=True)
    found = matrices_to_quaternions(quaternions_to_matrices(some))
    assert np.allclose(np.abs(np.sum(found * some, axis=1)), 1)
    assert np.all(found[:, 0] >= 0)
