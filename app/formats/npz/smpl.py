"""Reads SMPL, SMPL-H and SMPL-X parameters (for example AMASS files) as a recording.

A parameter file contains the angles of a body model, but not its joints. To compute these one needs
the model, which is licensed and not a part of Kinedex. The angles are read exactly and turn a
generic body of our own. Its segments have the proportions of Drillis and Contini (1966; Winter,
"Biomechanics and motor control of human movement", fig. 4.1). So the directions of limbs are as
recorded, but their lengths are generic, and the feet are a few centimeters above or below the
ground. Fingers and face are left out.

Sources: Loper et al., "SMPL" (2015), for the order of joints and the axis-angle parameters; Mahmood
et al., "AMASS" (2019), for the keys of the file.
"""

from __future__ import annotations

import numpy as np

from app.formats.common.failures import unreadable_at
from app.formats.npz.joint_layouts import SMPL_BODY
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Caution, Recording
from app.motion.skeleton.rotations import identity_quaternions, multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

STATURE = 1.7
"""Meters: the stature of the generic body."""
BODY_JOINTS = 22
"""The number of joints, at the start of the order, that all SMPL models share."""
PARAMETERS = (66, 72, 156, 165)
"""The numbers of a frame: body alone, SMPL, SMPL-H, SMPL-X."""

_CAUTION = Caution(
    "body_model_missing",
    "the file has angles of the SMPL body model, which Kinedex does not have: angles are exact,"
    f" limb lengths are those of a generic body {STATURE} m tall (betas and gender are not used),"
    " fingers and face are left out",
)

# Offsets in the rest pose, as shares of the stature. Left is +X, up is +Y, forward is +Z, and the
# arms point to the sides.
_LEG = {
    "Hip": (0.055, -0.045, 0),
    "Knee": (0, -0.245, 0),
    "Ankle": (0, -0.246, -0.01),
    "Foot": (0.01, -0.03, 0.075),
}
_ARM = {
    "Collar": (0.035, 0.075, 0),
    "Shoulder": (0.075, 0.02, -0.005),
    "Elbow": (0.186, 0, 0),
    "Wrist": (0.146, 0, 0),
    "Hand": (0.05, 0, 0),
}
_TRUNK = {
    "Pelvis": (0, -0.13, 0.01),
    "Spine1": (0, 0.065, -0.015),
    "Spine2": (0, 0.075, 0.01),
    "Spine3": (0, 0.035, 0.005),
    "Neck": (0, 0.13, -0.015),
    "Head": (0, 0.05, 0.02),
}

_Y_TO_Z_UP = np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0, 0.0])
"""The quaternion of 90 degrees about X, which turns Y up to Z up."""


def read_smpl(
    poses: FloatArray,
    translation: FloatArray | None,
    frame_rate: float | None,
    up_axis: str = "z",
) -> Recording:
    """A recording of 24 joints in meters from axis-angle parameters.

    poses: (frames, n) rotation vectors in radians, the root first; n is one of PARAMETERS.
    translation: (frames, 3) meters, or None if the root does not move. Both must be finite.
    frame_rate: Hz. up_axis: "z" as in AMASS, or "y". Raises Unreadable.
    """
    frames = len(poses)
    if poses.ndim != 2 or poses.shape[1] not in PARAMETERS:
        counts = ", ".join(map(str, PARAMETERS))
        shape = "x".join(map(str, poses.shape))
        raise unreadable_at(
            "poses", f"expected frames x ({counts}) axis-angle numbers, found {shape}"
        )
    if translation is not None and translation.shape != (frames, 3):
        shape = "x".join(map(str, translation.shape))
        raise unreadable_at(
            "trans", f"expected {frames}x3 numbers as poses has frames, found {shape}"
        )
    skeleton = generic_body()
    rotations = _rotations(poses, len(skeleton))
    roots = np.broadcast_to(skeleton.offsets[0], (frames, 3))
    if translation is not None:
        roots = roots + translation
    if up_axis == "z":
        skeleton, rotations = _with_z_up_rest(skeleton, rotations)
    positions = forward_kinematics(skeleton, rotations, local_translations(skeleton, roots))
    return Recording(
        format="npz",
        skeleton=skeleton,
        positions=positions.astype(np.float32),
        rotations=rotations.astype(np.float32),
        translations=None,
        frame_rate=frame_rate,
        up_axis=up_axis,
        metres_per_unit=1.0,
        cautions=(_CAUTION,),
    )


def generic_body() -> Skeleton:
    """The 24 joints of SMPL with our own approximate offsets in meters, Y up.

    The offset of the root is about that of the model's pelvis from the model's origin.
    """
    names = (*SMPL_BODY[0], "L_Hand", "R_Hand")
    wrists = tuple(names.index(wrist) for wrist in ("L_Wrist", "R_Wrist"))
    return Skeleton(
        names=names,
        parents=np.array(SMPL_BODY[1] + wrists),
        offsets=STATURE * np.array([_share(name) for name in names], dtype=np.float64),
    )


def _share(name: str) -> tuple[float, float, float]:
    if name in _TRUNK:
        return _TRUNK[name]
    x, y, z = (_LEG | _ARM)[name[2:]]
    return (x if name.startswith("L_") else -x, y, z)


def _rotations(poses: FloatArray, joints: int) -> FloatArray:
    """(frames, joints, 4) the local quaternions. Angles of fingers and face are not used.

    SMPL has angles for its two hand joints. The other models have angles of fingers instead.
    """
    result = identity_quaternions((len(poses), joints))
    count = joints if poses.shape[1] == 3 * joints else BODY_JOINTS
    vectors = poses[:, : 3 * count].reshape(len(poses), count, 3)
    result[:, :count] = rotation_vectors_to_quaternions(vectors)
    return result


def rotation_vectors_to_quaternions(vectors: FloatArray) -> FloatArray:
    """Unit quaternions (..., 4) of rotation vectors (..., 3): axis times angle in radians."""
    angle = np.linalg.norm(vectors, axis=-1, keepdims=True)
    # sin(angle / 2) / angle, by numpy's sinc, which does not divide by 0
    share = 0.5 * np.sinc(angle / (2 * np.pi))
    return np.concatenate([np.cos(angle / 2), share * vectors], axis=-1)


def _with_z_up_rest(skeleton: Skeleton, rotations: FloatArray) -> tuple[Skeleton, FloatArray]:
    """The same movement with a rest pose whose up axis is Z, as in the world.

    With the turn C from Y up to Z up, local rotations R become C R C*. The world rotation of the
    root is given for the Z-up world, so it becomes R C*.
    """
    turn, back = _Y_TO_Z_UP, _Y_TO_Z_UP * [1, -1, -1, -1]
    turned = multiply(multiply(turn, rotations), back)
    turned[:, 0] = multiply(rotations[:, 0], back)
    offsets = rotate(turn, skeleton.offsets)
    return Skeleton(skeleton.names, skeleton.parents, offsets), turned
