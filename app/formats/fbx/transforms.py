"""An FBX node's transform, and world transforms down its tree.

The local matrix is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1; how a parent's scale
reaches its children depends on the child's inherit type. Rotation orders name the axis
that turns first, pre- and post-rotation are XYZ always.

Source: Autodesk FBX SDK 2020, "Computing transformation matrices", and its sample
"Transformations" for the inherit types.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.fbx.scene import FbxObject, FbxScene, refused_at
from app.motion.skeleton.kinematics import joints_by_depth
from app.motion.skeleton.rotations import (
    euler_to_quaternions,
    multiply,
    quaternions_to_matrices,
    rotate,
)
from app.numerics.arrays import FloatArray, IntArray

ROTATION_ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")
"""The order for each number; the first axis turns first. The sixth, SphericXYZ, is unsupported."""
R_S_INDEPENDENT, R_S_TOGETHER, WITHOUT_PARENT = 0, 1, 2
"""InheritType: RrSs (scales multiply apart from rotations), RSrs (matrices multiply),
Rrs (the parent's own scale is left out)."""
ANIMATED = ("Lcl Translation", "Lcl Rotation", "Lcl Scaling")
SHEAR = 1e-4
"""The largest entry off the diagonal, relative to the largest entry, of a matrix without shear."""

_ZERO, _ONE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
_FIXED = (
    "RotationOffset", "RotationPivot", "PreRotation", "PostRotation", "ScalingOffset",
    "ScalingPivot",
)  # fmt: skip
FIXED = (*_FIXED, "RotationOrder", "InheritType", "RotationActive")
"""Properties of the chain that must not be animated."""


@dataclass(frozen=True, slots=True)
class FbxNode:
    """A node's chain: `order` names the first axis first; vectors (3,) in degrees and units."""

    node: FbxObject
    order: str
    inherits: int
    rotation_offset: FloatArray
    rotation_pivot: FloatArray
    before: FloatArray
    after: FloatArray
    scaling_offset: FloatArray
    scaling_pivot: FloatArray
    still: tuple[FloatArray, FloatArray, FloatArray]

    @property
    def has_pivots(self) -> bool:
        """Whether turning or scaling moves the node's origin."""
        return bool(np.any(self.rotation_pivot - self.scaling_offset) or np.any(self.scaling_pivot))

    def turned(self, degrees: FloatArray) -> FloatArray:
        """Local rotations (..., 4) of Euler angles (..., 3): Rpre R Rpost^-1."""
        # Our intrinsic order lists the outermost axis first, which is the one that turns last.
        order = self.order[::-1]
        angles = np.radians(degrees)[..., ["XYZ".index(axis) for axis in order]]
        turned = multiply(_fixed(self.before), euler_to_quaternions(angles, order))
        return multiply(turned, _fixed(self.after) * [1, -1, -1, -1])

    def moved(self, translation: FloatArray, turned: FloatArray, scale: FloatArray) -> FloatArray:
        """Where the node's origin is in its parent's frame (..., 3)."""
        inner = self.scaling_offset - self.rotation_pivot + (1 - scale) * self.scaling_pivot
        return translation + self.rotation_offset + self.rotation_pivot + rotate(turned, inner)


def read_node(scene: FbxScene, node: FbxObject) -> FbxNode:
    """Read the chain of a node.

    Raises FormatNotSupported for unknown chains, and Unreadable.
    """
    # A node whose rotation is not "active" turns in XYZ about nothing else.
    active = scene.number(node, "RotationActive", 0.0) != 0
    active &= scene.number(node, "RotationSpaceForLimitOnly", 0.0) == 0
    order = int(scene.number(node, "RotationOrder", 0.0)) if active else 0
    if order not in range(len(ROTATION_ORDERS)):
        raise refused_at(node.place, f"expected rotation order 0 to 5, found {order}")
    inherits = int(scene.number(node, "InheritType", 0.0))
    if inherits not in (R_S_INDEPENDENT, R_S_TOGETHER, WITHOUT_PARENT):
        raise refused_at(node.place, f"expected inherit type 0, 1 or 2, found {inherits}")
    fixed = {name: scene.vector(node, name, _ZERO) for name in _FIXED}
    return FbxNode(
        node=node,
        order=ROTATION_ORDERS[order],
        inherits=inherits,
        rotation_offset=fixed["RotationOffset"],
        rotation_pivot=fixed["RotationPivot"],
        before=fixed["PreRotation"] if active else np.zeros(3),
        after=fixed["PostRotation"] if active else np.zeros(3),
        scaling_offset=fixed["ScalingOffset"],
        scaling_pivot=fixed["ScalingPivot"],
        still=(
            scene.vector(node, ANIMATED[0], _ZERO),
            scene.vector(node, ANIMATED[1], _ZERO),
            scene.vector(node, ANIMATED[2], _ONE),
        ),
    )


def _fixed(degrees: FloatArray) -> FloatArray:
    return euler_to_quaternions(np.radians(degrees[::-1]), "ZYX")


@dataclass(frozen=True, slots=True)
class Local:
    """translations (frames, nodes, 3), rotations (frames, nodes, 4), scales (frames, nodes, 3)."""

    translations: FloatArray
    rotations: FloatArray
    scales: FloatArray


@dataclass(frozen=True, slots=True)
class World:
    """rotations (frames, nodes, 4), without scale; positions (frames, nodes, 3)."""

    rotations: FloatArray
    positions: FloatArray


def world_transforms(nodes: list[FbxNode], parents: IntArray, local: Local) -> World:
    """From local to world; parents (nodes,), -1 for a root, stand before their children.

    Raises FormatNotSupported where a sheared parent's scale would have to be split.
    """
    turned = np.array(local.rotations)
    positions = np.array(local.translations)
    matrices = quaternions_to_matrices(turned) * local.scales[..., None, :]
    inherits = np.array([node.inherits for node in nodes])
    for depth in joints_by_depth(parents)[1:]:
        above = parents[depth]
        positions[:, depth] = positions[:, above] + _apply(matrices[:, above], positions[:, depth])
        for kind in (R_S_INDEPENDENT, R_S_TOGETHER, WITHOUT_PARENT):
            joints = depth[inherits[depth] == kind]
            if len(joints):
                matrices[:, joints] = _inherited(
                    nodes, parents, kind, joints, turned, matrices, local
                )
        turned[:, depth] = multiply(turned[:, above], turned[:, depth])
    return World(turned, positions)


def _apply(matrices: FloatArray, vectors: FloatArray) -> FloatArray:
    return np.asarray((matrices @ vectors[..., None])[..., 0])


def _inherited(
    nodes: list[FbxNode],
    parents: IntArray,
    kind: int,
    joints: IntArray,
    turned: FloatArray,
    matrices: FloatArray,
    local: Local,
) -> FloatArray:
    """World matrices (frames, joints, 3, 3) of nodes of one inherit type; `turned` holds
    world rotations for the nodes above them, their own local ones for themselves."""
    above = parents[joints]
    own = local.scales[:, joints, None, :]
    if kind == R_S_TOGETHER:
        return matrices[:, above] @ (quaternions_to_matrices(turned[:, joints]) * own)
    upper = quaternions_to_matrices(turned[:, above])
    scales = np.swapaxes(upper, -1, -2) @ matrices[:, above]
    _refuse_shear(nodes, joints, scales)
    if kind == WITHOUT_PARENT:
        scales = scales / _without_zeros(nodes, joints, local.scales[:, above])[..., None, :]
    return upper @ quaternions_to_matrices(turned[:, joints]) @ (scales * own)


def _refuse_shear(nodes: list[FbxNode], joints: IntArray, scales: FloatArray) -> None:
    size = np.abs(scales).max(axis=(0, 2, 3))
    sheared = np.abs(scales * (1 - np.eye(3))).max(axis=(0, 2, 3)) > SHEAR * size
    if sheared.any():
        place = nodes[int(joints[np.argmax(sheared)])].node.place
        raise refused_at(place, "expected no shear above a node that inherits scale apart")


def _without_zeros(nodes: list[FbxNode], joints: IntArray, scales: FloatArray) -> FloatArray:
    zero = (np.abs(scales) < 1e-12).any(axis=(0, 2))
    if zero.any():
        raise nodes[int(joints[np.argmax(zero)])].node.unreadable("expected a parent with a size")
    return scales
