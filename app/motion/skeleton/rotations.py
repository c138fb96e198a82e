"""Rotations as unit quaternions and Euler angles, vectorized over any leading axes.

Quaternions are (..., 4), w x y z, and turn column vectors v by q v q*. Euler angles are intrinsic:
the order "ZXY" means R = Rz(a0) Rx(a1) Ry(a2). This is the order of the channels in BVH files
(Meredith and Maddock, "Motion capture file formats explained", 2001).

We have our own functions because scipy's Rotation is slower: for 150 frames of 31 joints it needs
8 times as long to read angles (4.1 ms instead of .50), and 18 times as long for a product (2.0 ms
instead of .11). It turns points equally fast (tests/bench/test_libraries.py). Before scipy 1.17 its
arrays have only one axis.
"""

from __future__ import annotations

import numpy as np

from app.numerics.arrays import FloatArray

AXES = "XYZ"
GIMBAL_LIMIT = 1.0 - 1e-12
"""The sine of the middle angle above which the first and the last axis count as the same."""


def euler_to_quaternions(angles_rad: FloatArray, order: str) -> FloatArray:
    """(..., 4) unit quaternions of intrinsic Euler angles (..., len(order)) in radians.

    order: the axes from the outermost to the innermost, for example "ZXY". Any number of axes is
    allowed, and an axis may occur twice. No axis gives the identity.
    """
    if not order:
        return identity_quaternions(angles_rad.shape[:-1])
    result, *others = (
        _about_axis(angles_rad[..., index], AXES.index(axis)) for index, axis in enumerate(order)
    )
    for turn in others:
        result = multiply(result, turn)
    return result


def identity_quaternions(shape: tuple[int, ...]) -> FloatArray:
    """Identity quaternions of shape (*shape, 4)."""
    result = np.zeros((*shape, 4))
    result[..., 0] = 1.0
    return result


def _about_axis(angle: FloatArray, axis: int) -> FloatArray:
    """(..., 4) the quaternions of turns by `angle` (...,) radians about X, Y or Z (0, 1, 2)."""
    result = np.zeros((*angle.shape, 4))
    result[..., 0] = np.cos(angle / 2)
    result[..., 1 + axis] = np.sin(angle / 2)
    return result


def multiply(left: FloatArray, right: FloatArray) -> FloatArray:
    """Hamilton product (..., 4) of two arrays of quaternions (..., 4)."""
    a, b, c, d = (left[..., i] for i in range(4))
    e, f, g, h = (right[..., i] for i in range(4))
    product = np.empty(np.broadcast_shapes(left.shape, right.shape))
    product[..., 0] = a * e - b * f - c * g - d * h
    product[..., 1] = a * f + b * e + c * h - d * g
    product[..., 2] = a * g - b * h + c * e + d * f
    product[..., 3] = a * h + b * g - c * f + d * e
    return product


def conjugate(quaternions: FloatArray) -> FloatArray:
    """The inverses (..., 4) of unit quaternions (..., 4)."""
    return np.asarray(quaternions * [1.0, -1.0, -1.0, -1.0])


def rotate(quaternions: FloatArray, vectors: FloatArray) -> FloatArray:
    """Vectors (..., 3) turned by unit quaternions (..., 4): v + 2 u x (u x v + w v)."""
    w, u = quaternions[..., :1], quaternions[..., 1:]
    return vectors + 2.0 * cross(u, cross(u, vectors) + w * vectors)


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """The cross product (..., 3) of two arrays of vectors (..., 3).

    numpy's own is slower, because it spends most of its time on moving axes.
    """
    x, y, z = a[..., 0], a[..., 1], a[..., 2]
    u, v, w = b[..., 0], b[..., 1], b[..., 2]
    product = np.empty(np.broadcast_shapes(a.shape, b.shape))
    product[..., 0] = y * w - z * v
    product[..., 1] = z * u - x * w
    product[..., 2] = x * v - y * u
    return product


def quaternions_to_matrices(quaternions: FloatArray) -> FloatArray:
    """Rotation matrices (..., 3, 3), row-major, of unit quaternions (..., 4)."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def matrices_to_quaternions(matrices: FloatArray) -> FloatArray:
    """Unit quaternions (..., 4) with w >= 0 of rotation matrices (..., 3, 3).

    The largest of the four components is computed first, so that there is no division by a small
    number (Shepperd 1978).
    """
    m = np.asarray(matrices, dtype=np.float64)
    trace = m[..., 0, 0] + m[..., 1, 1] + m[..., 2, 2]
    # outer (..., 4, 4): row i is the quaternion, multiplied by 4 times its component i
    outer = np.empty((*m.shape[:-2], 4, 4))
    outer[..., 0, 0] = 1 + trace
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        outer[..., i + 1, i + 1] = 1 + 2 * m[..., i, i] - trace
        outer[..., 0, i + 1] = outer[..., i + 1, 0] = m[..., k, j] - m[..., j, k]
        outer[..., i + 1, j + 1] = outer[..., j + 1, i + 1] = m[..., j, i] + m[..., i, j]
    best = np.argmax(np.diagonal(outer, axis1=-2, axis2=-1), axis=-1)
    result = np.take_along_axis(outer, best[..., None, None], axis=-2)[..., 0, :]
    result = result / np.linalg.norm(result, axis=-1, keepdims=True)
    return np.asarray(np.where(result[..., :1] < 0, -result, result))


def quaternions_to_euler(quaternions: FloatArray, order: str) -> FloatArray:
    """Intrinsic Euler angles (..., 3) in radians of unit quaternions (..., 4).

    order: each of X, Y, Z once, the outermost axis first. The middle angle is in [-pi/2, pi/2]. In
    gimbal lock the last angle is 0, because only the sum or difference of two angles is determined.
    """
    i, j, k = (AXES.index(axis) for axis in order)
    sign = 1.0 if (j - i) % 3 == 1 else -1.0
    m = quaternions_to_matrices(quaternions)
    sine = sign * m[..., i, k]
    # arcsin(sine) would lose half of the digits near 90 degrees.
    middle = np.arctan2(sine, np.hypot(m[..., i, i], m[..., i, j]))
    locked = np.abs(sine) > GIMBAL_LIMIT
    first = np.arctan2(-sign * m[..., j, k], m[..., k, k])
    last = np.arctan2(-sign * m[..., i, j], m[..., i, i])
    locked_first = np.arctan2(sign * m[..., k, j], m[..., j, j])
    return np.stack(
        [np.where(locked, locked_first, first), middle, np.where(locked, 0.0, last)],
        axis=-1,
    )
