"""The local transforms of FBX nodes, and the world transforms of a tree of nodes.

The local matrix is T Roff Rp Rpre R Rpost^-1 Rp^-1 Soff Sp S Sp^-1 (translation, offset and pivot
of rotation, pre-rotation, rotation, post-rotation, offset and pivot of scaling, scaling). The
inherit type of a node decides how the scale of its parent changes it. A rotation order names the
axis that turns first, first. Pre- and post-rotation always have the order XYZ.

Source: Autodesk FBX SDK 2020, "Computing transformation matrices"; for the inherit types, its
sample "Transformations".
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.fbx.objects import FbxObject, unsupported_at
from app.formats.fbx.scene import FbxScene
from app.motion.skeleton.kinematics import joints_by_depth
from app.motion.skeleton.rotations import (
    euler_to_quaternions,
    multiply,
    quaternions_to_matrices,
    rotate,
)
from app.numerics.arrays import FloatArray, IntArray

ROTATION_ORDERS = ("XYZ", "XZY", "YZX", "YXZ", "ZXY", "ZYX")
"""The order for each number; the first axis turns first. Number 6 (SphericXYZ) is unsupported."""
R_S_INDEPENDENT, R_S_TOGETHER, WITHOUT_PARENT = 0, 1, 2
"""InheritType, with R, S for the parent and r, s for the node. RrSs: rotations and scales are
multiplied separately. RSrs: matrices are multiplied. Rrs: the parent's own scale is not used."""
ANIMATED_PROPERTIES = ("Lcl Translation", "Lcl Rotation", "Lcl Scaling")
MAX_SHEAR = 1e-4
"""The largest entry off the diagonal of a matrix without shear, relative to its largest entry."""

_ZERO, _ONE = (0.0, 0.0, 0.0), (1.0, 1.0, 1.0)
_FIXED_VECTORS = (
    "RotationOffset", "RotationPivot", "PreRotation", "PostRotation", "ScalingOffset",
    "ScalingPivot",
)  # fmt: skip
FIXED_PROPERTIES = (*_FIXED_VECTORS, "RotationOrder", "InheritType", "RotationActive")
"""Properties of a transform that must not be animated."""


@dataclass(frozen=True, slots=True)
class FbxNode:
    """A node with the fixed parts of its transform.

    order: the rotation order, the axis that turns first, first. inherits: the InheritType. Vectors
    are (3,), float64: rotations in degrees, others in the unit of the file. before, after: pre- and
    post-rotation. still: the translation, rotation and scale of the node without animation.
    """

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
        """Whether a rotation or a scale of the node moves its origin."""
        return bool(np.any(self.rotation_pivot - self.scaling_offset) or np.any(self.scaling_pivot))

    def local_rotations(self, degrees: FloatArray) -> FloatArray:
        """(..., 4) the quaternions Rpre R Rpost^-1; degrees: (..., 3) Euler angles X, Y, Z."""
        # Our function names the outermost axis first, which is the axis that turns last.
        order = self.order[::-1]
        angles = np.radians(degrees)[..., ["XYZ".index(axis) for axis in order]]
        turned = multiply(_xyz_rotation(self.before), euler_to_quaternions(angles, order))
        return multiply(turned, _xyz_rotation(self.after) * [1, -1, -1, -1])

    def origin(self, translation: FloatArray, turned: FloatArray, scale: FloatArray) -> FloatArray:
        """(..., 3) the origin of the node in the frame of its parent, in the unit of the file.

        translation, scale: (..., 3). turned: (..., 4) the local rotations.
        """
        inner = self.scaling_offset - self.rotation_pivot + (1 - scale) * self.scaling_pivot
        return translation + self.rotation_offset + self.rotation_pivot + rotate(turned, inner)


def read_node(scene: FbxScene, node: FbxObject) -> FbxNode:
    """Read the fixed parts of the transform of a node.

    Raises FormatNotSupported for an unknown rotation order or inherit type, and Unreadable.
    """
    # If the rotation is not "active", its order is XYZ, and pre- and post-rotation are not used.
    active = scene.number(node, "RotationActive", 0.0) != 0
    active &= scene.number(node, "RotationSpaceForLimitOnly", 0.0) == 0
    order = int(scene.number(node, "RotationOrder", 0.0)) if active else 0
    if order not in range(len(ROTATION_ORDERS)):
        raise unsupported_at(node.location, f"expected rotation order 0 to 5, found {order}")
    inherits = int(scene.number(node, "InheritType", 0.0))
    if inherits not in (R_S_INDEPENDENT, R_S_TOGETHER, WITHOUT_PARENT):
        raise unsupported_at(node.location, f"expected inherit type 0, 1 or 2, found {inherits}")
    fixed = {name: scene.vector(node, name, _ZERO) for name in _FIXED_VECTORS}
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
            scene.vector(node, ANIMATED_PROPERTIES[0], _ZERO),
            scene.vector(node, ANIMATED_PROPERTIES[1], _ZERO),
            scene.vector(node, ANIMATED_PROPERTIES[2], _ONE),
        ),
    )


def _xyz_rotation(degrees: FloatArray) -> FloatArray:
    """(4,) the quaternion of Euler angles (3,) of which X turns first."""
    return euler_to_quaternions(np.radians(degrees[::-1]), "ZYX")


@dataclass(frozen=True, slots=True)
class Local:
    """Local transforms of nodes.

    translations: (frames, nodes, 3) in the unit of the file. rotations: (frames, nodes, 4)
    quaternions w x y z. scales: (frames, nodes, 3).
    """

    translations: FloatArray
    rotations: FloatArray
    scales: FloatArray


@dataclass(frozen=True, slots=True)
class World:
    """World transforms of nodes, in the unit and axes of the file.

    rotations: (frames, nodes, 4) quaternions, without scale. positions: (frames, nodes, 3).
    """

    rotations: FloatArray
    positions: FloatArray


def world_transforms(nodes: list[FbxNode], parents: IntArray, local: Local) -> World:
    """The world transforms of nodes from their local transforms.

    parents: (nodes,), -1 for a root; parents come before their children. Raises FormatNotSupported
    if the scale of a sheared parent must be separated from its rotation, and Unreadable for a
    parent with scale 0 that must be divided out.
    """
    turned = np.array(local.rotations)
    positions = np.array(local.translations)
    # matrices (frames, nodes, 3, 3): world rotations with scale; local ones for nodes that follow
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
    """(..., 3) the products of matrices (..., 3, 3) and vectors (..., 3)."""
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
    """(frames, joints, 3, 3) the world matrices of the nodes `joints`, all of one inherit type.

    turned: (frames, nodes, 4) world rotations for the parents, but local rotations for `joints`.
    matrices: (frames, nodes, 3, 3) world matrices of the parents.
    """
    above = parents[joints]
    own = local.scales[:, joints, None, :]
    if kind == R_S_TOGETHER:
        return matrices[:, above] @ (quaternions_to_matrices(turned[:, joints]) * own)
    # The matrix of the parent is its rotation times its scale, so R^-1 M is the scale.
    upper = quaternions_to_matrices(turned[:, above])
    scales = np.swapaxes(upper, -1, -2) @ matrices[:, above]
    _refuse_shear(nodes, joints, scales)
    if kind == WITHOUT_PARENT:
        scales = scales / _without_zeros(nodes, joints, local.scales[:, above])[..., None, :]
    return upper @ quaternions_to_matrices(turned[:, joints]) @ (scales * own)


def _refuse_shear(nodes: list[FbxNode], joints: IntArray, scales: FloatArray) -> None:
    size = np.abs(scales).max(axis=(0, 2, 3))
    sheared = np.abs(scales * (1 - np.eye(3))).max(axis=(0, 2, 3)) > MAX_SHEAR * size
    if sheared.any():
        location = nodes[int(joints[np.argmax(sheared)])].node.location
        raise unsupported_at(location, "expected no shear above a node of inherit type RrSs or Rrs")


def _without_zeros(nodes: list[FbxNode], joints: IntArray, scales: FloatArray) -> FloatArray:
    zero = (np.abs(scales) < 1e-12).any(axis=(0, 2))
    if zero.any():
        raise nodes[int(joints[np.argmax(zero)])].node.unreadable("expected a parent with a size")
    return scales
