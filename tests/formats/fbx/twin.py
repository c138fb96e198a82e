"""The slow twin of the FBX transforms: 4x4 matrices, node by node, frame by frame."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from app.numerics.arrays import FloatArray
from tests.formats.fbx.files import Bone

ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")


def translated(vector: Sequence[float]) -> FloatArray:
    matrix = np.eye(4)
    matrix[:3, 3] = vector
    return matrix


def scaled(vector: Sequence[float]) -> FloatArray:
    return np.diag([*vector, 1.0])


def turned(degrees: Sequence[float], order: str = "XYZ") -> FloatArray:
    """The 4x4 matrix of Euler angles; the first axis of the order turns first."""
    matrix = np.eye(4)
    for axis in order:
        index = "XYZ".index(axis)
        c, s = np.cos(np.radians(degrees[index])), np.sin(np.radians(degrees[index]))
        one = np.eye(4)
        j, k = (index + 1) % 3, (index + 2) % 3
        one[j, j], one[j, k], one[k, j], one[k, k] = c, -s, s, c
        matrix = one @ matrix
    return matrix


def world_positions(
    bones: Sequence[Bone], animated: Mapping[tuple[int, str], Sequence[float]]
) -> FloatArray:
    """(bones, 3) the positions in one frame; `animated` replaces properties by (bone, name)."""
    world: list[tuple[FloatArray, FloatArray, FloatArray]] = []
    result = []
    for index, bone in enumerate(bones):
        above = world[bone.parent] if bone.parent >= 0 else None
        world.append(_world(index, bone, animated, above))
        result.append(world[-1][0][:3, 3])
    return np.array(result)


def _world(
    index: int,
    bone: Bone,
    animated: Mapping[tuple[int, str], Sequence[float]],
    above: tuple[FloatArray, FloatArray, FloatArray] | None,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """World matrix, world rotation and own scale, as in the sample "Transformations" of the SDK."""

    def get(name: str, default: float = 0.0) -> Sequence[float]:
        value = animated.get((index, name), bone.properties.get(name, (default,) * 3))
        return tuple(value)

    active = bone.properties.get("RotationActive", 0)
    order = ORDERS[bone.properties.get("RotationOrder", 0)] if active else "XYZ"
    before = turned(get("PreRotation")) if active else np.eye(4)
    after = turned(get("PostRotation")) if active else np.eye(4)
    rotation = before @ turned(get("Lcl Rotation"), order) @ np.linalg.inv(after)
    scale = scaled(get("Lcl Scaling", 1.0))
    pivot, scaling_pivot = translated(get("RotationPivot")), translated(get("ScalingPivot"))
    local = translated(get("Lcl Translation")) @ translated(get("RotationOffset")) @ pivot
    local = local @ rotation @ np.linalg.inv(pivot) @ translated(get("ScalingOffset"))
    local = local @ scaling_pivot @ scale @ np.linalg.inv(scaling_pivot)
    if above is None:
        return local, rotation, scale
    parent, parent_rotation, parent_scale = above
    parent_linear = parent.copy()
    parent_linear[:3, 3] = 0
    size = np.linalg.inv(parent_rotation) @ parent_linear
    inherits = bone.properties.get("InheritType", 0)
    if inherits == 1:
        linear = parent_rotation @ size @ rotation @ scale
    elif inherits == 0:
        linear = parent_rotation @ rotation @ size @ scale
    else:
        linear = parent_rotation @ rotation @ size @ np.linalg.inv(parent_scale) @ scale
    result = translated((parent @ local)[:3, 3]) @ linear
    return result, parent_rotation @ rotation, scale
