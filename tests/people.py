"""Recordings of one person in many naming conventions, for tests of joint roles and readers."""

from __future__ import annotations

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import euler_to_quaternions
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

R = JointRole

# Joint role, parent role, offset from the parent in meters. Left is +X, forward +Z, up +Y.
BODY: tuple[tuple[JointRole, JointRole | None, tuple[float, float, float]], ...] = (
    (R.HIPS, None, (0, 0.95, 0)),
    (R.CHEST, R.HIPS, (0, 0.3, -0.02)),
    (R.NECK, R.CHEST, (0, 0.22, 0)),
    (R.HEAD, R.NECK, (0, 0.12, 0.03)),
    (R.LEFT_SHOULDER, R.CHEST, (0.18, 0.18, 0)),
    (R.LEFT_ELBOW, R.LEFT_SHOULDER, (0.29, 0, 0)),
    (R.LEFT_HAND, R.LEFT_ELBOW, (0.25, 0, 0)),
    (R.RIGHT_SHOULDER, R.CHEST, (-0.18, 0.18, 0)),
    (R.RIGHT_ELBOW, R.RIGHT_SHOULDER, (-0.29, 0, 0)),
    (R.RIGHT_HAND, R.RIGHT_ELBOW, (-0.25, 0, 0)),
    (R.LEFT_UPPER_LEG, R.HIPS, (0.1, -0.05, 0)),
    (R.LEFT_KNEE, R.LEFT_UPPER_LEG, (0, -0.42, 0)),
    (R.LEFT_FOOT, R.LEFT_KNEE, (0, -0.42, -0.01)),
    (R.LEFT_TOES, R.LEFT_FOOT, (0, -0.05, 0.14)),
    (R.RIGHT_UPPER_LEG, R.HIPS, (-0.1, -0.05, 0)),
    (R.RIGHT_KNEE, R.RIGHT_UPPER_LEG, (0, -0.42, 0)),
    (R.RIGHT_FOOT, R.RIGHT_KNEE, (0, -0.42, -0.01)),
    (R.RIGHT_TOES, R.RIGHT_FOOT, (0, -0.05, 0.14)),
)
ROLES = [role for role, _, _ in BODY]


def body_skeleton(names: dict[JointRole, str] | None = None, scale: float = 1.0) -> Skeleton:
    """The person's skeleton; without names the joints are called j0, j1, ..."""
    return Skeleton(
        names=tuple((names or {}).get(role, f"j{i}") for i, role in enumerate(ROLES)),
        parents=np.array([-1 if above is None else ROLES.index(above) for _, above, _ in BODY]),
        offsets=scale * np.array([offset for _, _, offset in BODY], dtype=float),
    )


def swaying_rotations(frames: int, joints: int, seed: int = 0, size: float = 0.3) -> FloatArray:
    """(frames, joints, 4) unit quaternions: every joint sways by about `size` radians."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0, 2 * np.pi, frames)[:, None, None]
    phase = rng.uniform(0, 2 * np.pi, (1, joints, 3))
    angles = size * rng.uniform(0.2, 1, (1, joints, 3)) * np.sin(t + phase)
    return euler_to_quaternions(angles, "ZXY")


def person(
    names: dict[JointRole, str] | None = None,
    *,
    frames: int = 40,
    scale: float = 1.0,
    seed: int = 0,
    frame_rate: float | None = 30.0,
) -> Recording:
    """A recording of the person, who stands and sways. One unit of length is 1 / scale meters."""
    skeleton = body_skeleton(names, scale)
    rotations = swaying_rotations(frames, len(skeleton), seed)
    roots = np.broadcast_to(skeleton.offsets[0], (frames, 3)).copy()
    positions = forward_kinematics(skeleton, rotations, local_translations(skeleton, roots))
    return Recording(
        format="bvh",
        skeleton=skeleton,
        positions=positions.astype(np.float32),
        rotations=rotations.astype(np.float32),
        translations=None,
        frame_rate=frame_rate,
    )


def convention(middle: str, sided: str, left: str, right: str) -> dict[JointRole, str]:
    """Joint names by role.

    middle: the names of hips, chest, neck and head; sided: patterns of the names of shoulder,
    elbow, hand, upper leg, knee, foot and toes, with {} for the side and ~ for a space; left,
    right: the texts that replace {}.
    """
    names = dict(zip((R.HIPS, R.CHEST, R.NECK, R.HEAD), middle.split(), strict=True))
    parts = ("shoulder", "elbow", "hand", "upper_leg", "knee", "foot", "toes")
    for part, pattern in zip(parts, sided.split(), strict=True):
        for side, mark in (("left", left), ("right", right)):
            names[R(f"{side}_{part}")] = pattern.format(mark).replace("~", " ")
    return names


CONVENTIONS: dict[str, dict[JointRole, str]] = {
    "MotionBuilder": convention(
        "Hips Spine1 Neck Head",
        "{}Arm {}ForeArm {}Hand {}UpLeg {}Leg {}Foot {}ToeBase", "Left", "Right",
    ),
    "ASF": convention(
        "root thorax lowerneck head",
        "{}humerus {}radius {}wrist {}femur {}tibia {}foot {}toes", "l", "r",
    ),
    "DAZ": convention(
        "hip chest neck head", "{}Shldr {}ForeArm {}Hand {}Thigh {}Shin {}Foot {}Toe", "l", "r"
    ),
    "Mixamo": convention(
        "mixamorig:Hips mixamorig:Spine2 mixamorig:Neck mixamorig:Head",
        "mixamorig:{0}Arm mixamorig:{0}ForeArm mixamorig:{0}Hand mixamorig:{0}UpLeg"
        " mixamorig:{0}Leg mixamorig:{0}Foot mixamorig:{0}ToeBase", "Left", "Right",
    ),
    "Bandai Namco": convention(
        "Hips Chest Neck Head",
        "UpperArm_{} LowerArm_{} Hand_{} UpperLeg_{} LowerLeg_{} Foot_{} Toes_{}", "L", "R",
    ),
    "SMPL": convention(
        "Pelvis Spine3 Neck Head", "{}_Shoulder {}_Elbow {}_Wrist {}_Hip {}_Knee {}_Ankle {}_Foot",
        "L", "R",
    ),
    "Xsens": convention(
        "Hips Chest4 Neck Head",
        "{}Shoulder {}Elbow {}Wrist {}Hip {}Knee {}Ankle {}Toe", "Left", "Right",
    ),
    "Unreal": convention(
        "pelvis spine_03 neck_01 head",
        "upperarm_{} lowerarm_{} hand_{} thigh_{} calf_{} foot_{} ball_{}", "l", "r",
    ),
    "3ds Max": convention(
        "Bip01_Pelvis Bip01_Spine1 Bip01_Neck Bip01_Head",
        "Bip01~{}~UpperArm Bip01~{}~Forearm Bip01~{}~Hand Bip01~{}~Thigh Bip01~{}~Calf"
        " Bip01~{}~Foot Bip01~{}~Toe0", "L", "R",
    ),
    "Blender": convention(
        "hips chest neck head", "upper_arm.{} forearm.{} hand.{} thigh.{} shin.{} foot.{} toe.{}",
        "L", "R",
    ),
    "OptiTrack": convention(
        "Hip Chest Neck Head", "{}UArm {}FArm {}Hand {}Thigh {}Shin {}Foot {}Toe", "L", "R"
    ),
    "Kinect": convention(
        "SpineBase SpineShoulder Neck Head",
        "Shoulder{} Elbow{} Wrist{} Hip{} Knee{} Ankle{} Foot{}", "Left", "Right",
    ),
    "VRM": convention(
        "J_Bip_C_Hips J_Bip_C_Chest J_Bip_C_Neck J_Bip_C_Head",
        "J_Bip_{0}_UpperArm J_Bip_{0}_LowerArm J_Bip_{0}_Hand J_Bip_{0}_UpperLeg"
        " J_Bip_{0}_LowerLeg J_Bip_{0}_Foot J_Bip_{0}_ToeBase", "L", "R",
    ),
    "A.R.T.": convention(
        "PELV UTSP NECK HEAD", "{}UAR {}LAR {}HAN {}ULE {}LLE {}FOO {}TOE", "L", "R"
    ),
    "plug-in-gait": convention(
        "pelvis thorax C7 head", "{}SHO {}ELB {}WRA {}HIP {}KNE {}ANK {}TOE", "L", "R"
    ),
}  # fmt: skip
