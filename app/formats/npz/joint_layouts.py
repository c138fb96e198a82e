"""Recognizes the joint order of positions without joint names.

An array (frames, joints, 3) only shows the number of joints, and several known orders have the same
number. An order is accepted if its bones are equally long on the left and on the right and keep
their length over time, and if no other order with this number of joints does the same.

Sources: the documentation of each order (SMPL, SMPL-H and SMPL-X by MPI; LAFAN1 by Ubisoft;
Human3.6M in 17 joints as in VideoPose3D; Kinect v2 SDK; OpenPose BODY_25; COCO; Halpe; MediaPipe
Pose).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from app.numerics.arrays import FloatArray

MAX_SIDE_DIFFERENCE = 0.2
"""The largest difference of left and right bones, as a share of their mean, including noise."""
MAX_LENGTH_DEVIATION = 0.2
"""The largest standard deviation of a bone's length over time, as a share of its mean. It is the
median over bones."""
MAX_CHECKED_FRAMES = 500
"""About the number of frames, evenly spaced, that are checked. More would not change the result."""


@dataclass(frozen=True, slots=True)
class JointLayout:
    """A known joint order.

    title: for people. names: (joints,). parents: (joints,) -1 for the root.
    """

    title: str
    names: tuple[str, ...]
    parents: tuple[int, ...]

    def paired_bones(self) -> list[tuple[int, int]]:
        """The index of each left joint, with that of the same joint on the right."""
        index = {name: joint for joint, name in enumerate(self.names)}
        return [(index[name], index[other]) for name, other in self._mirrored() if other in index]

    def _mirrored(self) -> Iterator[tuple[str, str]]:
        for name in self.names:
            if name.startswith(("Left", "L_")):
                yield name, name.replace("Left", "Right").replace("L_", "R_")
            elif name.endswith("Left"):
                yield name, name.removesuffix("Left") + "Right"


def _chains(*chains: str) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """Names in order of their first occurrence, and parents, from chains of names.

    In a chain, each joint is the parent of the next one.
    """
    parent_of: dict[str, str | None] = {}
    for chain in chains:
        names = chain.split()
        parent_of.setdefault(names[0], None)
        parent_of.update((name, parent) for parent, name in pairwise(names))
    names_in_order = tuple(parent_of)
    return names_in_order, _parent_indices(names_in_order, parent_of)


def _parent_indices(names: tuple[str, ...], parent_of: dict[str, str | None]) -> tuple[int, ...]:
    above = (parent_of[name] for name in names)
    return tuple(-1 if parent is None else names.index(parent) for parent in above)


def _ordered(order: str, *chains: str) -> tuple[tuple[str, ...], tuple[int, ...]]:
    """As `_chains`, but with the names in the order of `order`."""
    names, parents = _chains(*chains)
    parent_of = {name: None if p < 0 else names[p] for name, p in zip(names, parents, strict=True)}
    ordered_names = tuple(order.split())
    return ordered_names, _parent_indices(ordered_names, parent_of)


SMPL_BODY = _ordered(
    "Pelvis L_Hip R_Hip Spine1 L_Knee R_Knee Spine2 L_Ankle R_Ankle Spine3 L_Foot R_Foot Neck"
    " L_Collar R_Collar Head L_Shoulder R_Shoulder L_Elbow R_Elbow L_Wrist R_Wrist",
    "Pelvis L_Hip L_Knee L_Ankle L_Foot",
    "Pelvis R_Hip R_Knee R_Ankle R_Foot",
    "Pelvis Spine1 Spine2 Spine3 Neck Head",
    "Spine3 L_Collar L_Shoulder L_Elbow L_Wrist",
    "Spine3 R_Collar R_Shoulder R_Elbow R_Wrist",
)
_FINGERS = tuple(
    f"{side}_{finger}{part}"
    for side in "LR"
    for finger in ("Index", "Middle", "Pinky", "Ring", "Thumb")
    for part in (1, 2, 3)
)


def _with_fingers(
    names: tuple[str, ...], parents: tuple[int, ...]
) -> tuple[tuple[str, ...], tuple[int, ...]]:
    wrists = {side: names.index(f"{side}_Wrist") for side in "LR"}
    first = len(names)
    above = (
        wrists[name[0]] if name.endswith("1") else first + joint - 1
        for joint, name in enumerate(_FINGERS)
    )
    return names + _FINGERS, parents + tuple(above)


_HEAD, _L_WRIST, _R_WRIST = (SMPL_BODY[0].index(n) for n in ("Head", "L_Wrist", "R_Wrist"))

_COCO = (
    "Nose LEye REye LEar REar LeftShoulder RightShoulder LeftElbow RightElbow LeftWrist RightWrist"
    " LeftHip RightHip LeftKnee RightKnee LeftAnkle RightAnkle"
)
"""Small bones of the face are not compared, so their names do not begin with Left."""
_COCO_CHAINS = (
    "Nose LEye LEar",
    "Nose REye REar",
    "Nose LeftShoulder LeftElbow LeftWrist",
    "Nose RightShoulder RightElbow RightWrist",
    "LeftShoulder LeftHip LeftKnee LeftAnkle",
    "RightShoulder RightHip RightKnee RightAnkle",
)

LAYOUTS: tuple[JointLayout, ...] = (
    JointLayout("SMPL body", *SMPL_BODY),
    JointLayout("SMPL", SMPL_BODY[0] + ("L_Hand", "R_Hand"), SMPL_BODY[1] + (_L_WRIST, _R_WRIST)),
    JointLayout("SMPL-H", *_with_fingers(*SMPL_BODY)),
    JointLayout(
        "SMPL-X",
        *_with_fingers(SMPL_BODY[0] + ("Jaw", "L_Eye", "R_Eye"), SMPL_BODY[1] + (_HEAD,) * 3),
    ),
    JointLayout(
        "LAFAN1",
        *_chains(
            "Hips LeftUpLeg LeftLeg LeftFoot LeftToe",
            "Hips RightUpLeg RightLeg RightFoot RightToe",
            "Hips Spine Spine1 Spine2 Neck Head",
            "Spine2 LeftShoulder LeftArm LeftForeArm LeftHand",
            "Spine2 RightShoulder RightArm RightForeArm RightHand",
        ),
    ),
    JointLayout(
        "Human3.6M",
        *_chains(
            "Hips RightUpLeg RightLeg RightFoot",
            "Hips LeftUpLeg LeftLeg LeftFoot",
            "Hips Spine Neck Nose Head",
            "Neck LeftArm LeftForeArm LeftHand",
            "Neck RightArm RightForeArm RightHand",
        ),
    ),
    JointLayout(
        "Kinect v2",
        *_ordered(
            "SpineBase SpineMid Neck Head ShoulderLeft ElbowLeft WristLeft HandLeft ShoulderRight"
            " ElbowRight WristRight HandRight HipLeft KneeLeft AnkleLeft FootLeft HipRight"
            " KneeRight AnkleRight FootRight SpineShoulder HandTipLeft ThumbLeft HandTipRight"
            " ThumbRight",
            "SpineBase SpineMid SpineShoulder Neck Head",
            "SpineShoulder ShoulderLeft ElbowLeft WristLeft HandLeft HandTipLeft",
            "SpineShoulder ShoulderRight ElbowRight WristRight HandRight HandTipRight",
            "HandLeft ThumbLeft",
            "HandRight ThumbRight",
            "SpineBase HipLeft KneeLeft AnkleLeft FootLeft",
            "SpineBase HipRight KneeRight AnkleRight FootRight",
        ),
    ),
    JointLayout("COCO", *_ordered(_COCO, *_COCO_CHAINS)),
    JointLayout(
        "Halpe 26",
        *_ordered(
            f"{_COCO} Head Neck Hips LeftBigToe RightBigToe LeftSmallToe RightSmallToe LeftHeel"
            " RightHeel",
            *_COCO_CHAINS,
            "Nose Head",
            "Nose Neck Hips",
            "LeftAnkle LeftBigToe",
            "LeftAnkle LeftSmallToe",
            "LeftAnkle LeftHeel",
            "RightAnkle RightBigToe",
            "RightAnkle RightSmallToe",
            "RightAnkle RightHeel",
        ),
    ),
    JointLayout(
        "MediaPipe",
        *_ordered(
            "Nose LEyeInner LEye LEyeOuter REyeInner REye REyeOuter LEar REar LMouth RMouth"
            " LeftShoulder RightShoulder LeftElbow RightElbow LeftWrist RightWrist LeftPinky"
            " RightPinky LeftIndex RightIndex LeftThumb RightThumb LeftHip RightHip LeftKnee"
            " RightKnee LeftAnkle RightAnkle LeftHeel RightHeel LeftFootIndex RightFootIndex",
            *_COCO_CHAINS,
            "LEye LEyeInner",
            "LEye LEyeOuter",
            "REye REyeInner",
            "REye REyeOuter",
            "Nose LMouth",
            "Nose RMouth",
            "LeftWrist LeftPinky",
            "LeftWrist LeftIndex",
            "LeftWrist LeftThumb",
            "RightWrist RightPinky",
            "RightWrist RightIndex",
            "RightWrist RightThumb",
            "LeftAnkle LeftHeel",
            "LeftAnkle LeftFootIndex",
            "RightAnkle RightHeel",
            "RightAnkle RightFootIndex",
        ),
    ),
    JointLayout(
        "OpenPose BODY_25",
        *_ordered(
            "Nose Neck RightArm RightForeArm RightHand LeftArm LeftForeArm LeftHand Hips"
            " RightUpLeg RightLeg RightFoot LeftUpLeg LeftLeg LeftFoot RightEye LeftEye RightEar"
            " LeftEar LeftBigToe LeftSmallToe LeftHeel RightBigToe RightSmallToe RightHeel",
            "Hips Neck Nose",
            "Neck RightArm RightForeArm RightHand",
            "Neck LeftArm LeftForeArm LeftHand",
            "Hips RightUpLeg RightLeg RightFoot RightBigToe RightSmallToe",
            "Hips LeftUpLeg LeftLeg LeftFoot LeftBigToe LeftSmallToe",
            "RightFoot RightHeel",
            "LeftFoot LeftHeel",
            "Nose RightEye RightEar",
            "Nose LeftEye LeftEar",
        ),
    ),
)
"""All known joint orders. Several may have the same number of joints."""


def layout_of(positions: FloatArray) -> JointLayout | None:
    """The known joint order of `positions` (frames, joints, 3), in any unit and axes.

    None if no order gives a plausible body, or if several do.
    """
    step = max(1, len(positions) // MAX_CHECKED_FRAMES)
    some = positions[::step].astype(np.float64)
    plausible = [
        layout
        for layout in LAYOUTS
        if len(layout.names) == positions.shape[1] and _makes_a_body(layout, some)
    ]
    return plausible[0] if len(plausible) == 1 else None


def _makes_a_body(layout: JointLayout, positions: FloatArray) -> bool:
    """Whether bones have the same length on both sides and over time."""
    parents = np.array(layout.parents)
    lengths = np.linalg.norm(positions - positions[:, parents], axis=-1)  # (frames, joints)
    mean = lengths.mean(axis=0)
    # A bone without length cannot be compared, and the ratios below would divide by 0.
    if not (mean[parents >= 0] > 0).all():
        return False
    left, right = np.array(layout.paired_bones()).T
    difference = np.abs(mean[left] - mean[right]) / (0.5 * (mean[left] + mean[right]))
    deviation = lengths.std(axis=0)[parents >= 0] / mean[parents >= 0]
    return bool(
        np.median(deviation) < MAX_LENGTH_DEVIATION and difference.max() < MAX_SIDE_DIFFERENCE
    )
