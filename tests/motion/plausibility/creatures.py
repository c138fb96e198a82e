"""Animals, cartoon people and people on all fours, as recordings."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import euler_to_quaternions
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

Bones = Mapping[str, tuple[str | None, tuple[float, float, float]]]
"""The parent and the offset in meters of each joint: left is +X, forward is +Z, up is +Y."""


def pair(chain: str, parent: str, *offsets: tuple[float, float, float]) -> Bones:
    """A chain of joints on both sides. chain: names with {} for the side, separated by spaces."""
    bones: dict[str, tuple[str | None, tuple[float, float, float]]] = {}
    for side, sign in (("L", 1), ("R", -1)):
        above = parent
        for name, (x, y, z) in zip(chain.split(), offsets, strict=True):
            joint = name.format(side)
            bones[joint] = (above, (sign * x, y, z))
            above = joint
    return bones


def chain(names: str, parent: str | None, *offsets: tuple[float, float, float]) -> Bones:
    """A chain of joints in the middle of the body."""
    bones: dict[str, tuple[str | None, tuple[float, float, float]]] = {}
    for name, offset in zip(names.split(), offsets, strict=True):
        bones[name] = (parent, offset)
        parent = name
    return bones


def moving(
    bones: Bones, frames: int = 60, speed: float = 0.8, pitch: float = 0.0, height: float = 0.0
) -> Recording:
    """The body travels forward and swings every limb a little.

    speed: m/s. pitch: degrees by which the whole body leans forward. height: meters that the root
    is raised.
    """
    names = tuple(bones)
    skeleton = Skeleton(
        names,
        np.array([-1 if above is None else names.index(above) for above, _ in bones.values()]),
        np.array([offset for _, offset in bones.values()], dtype=np.float64),
    )
    t = np.linspace(0, 4 * np.pi, frames)
    angles: FloatArray = np.zeros((frames, len(names), 3))
    for joint, name in enumerate(names):
        if "L" in name or "R" in name:
            angles[:, joint, 0] = 0.15 * np.sin(t + joint)
    angles[:, 0, 0] = np.radians(pitch)
    roots = np.tile(skeleton.offsets[0], (frames, 1))
    roots[:, 1] += height
    roots[:, 2] += speed * np.arange(frames) / 30
    rotations = euler_to_quaternions(angles, "XYZ")
    positions = forward_kinematics(skeleton, rotations, local_translations(skeleton, roots))
    return Recording(
        format="bvh",
        skeleton=skeleton,
        positions=positions.astype(np.float32),
        rotations=rotations.astype(np.float32),
        translations=None,
        frame_rate=30.0,
    )


def without_rest(recording: Recording) -> Recording:
    """The same movement as positions alone, as C3D and NPY have it."""
    middle = np.median(recording.positions, axis=0).astype(np.float64)
    parents = recording.skeleton.parents
    offsets = np.where(parents[:, None] < 0, middle, middle - middle[parents])
    skeleton = Skeleton(recording.skeleton.names, parents, offsets)
    return Recording("npz", skeleton, recording.positions, None, None, 30.0)


HUMAN_NAMES = {
    "arm": "{}_UpperArm {}_Forearm {}_Hand",
    "leg": "{}_Thigh {}_Calf {}_Foot {}_Toe",
}


def four_legged(
    arm: str, leg: str, tail: str | None = None, size: float = 1.0, trunk: float = 0.55
) -> Bones:
    """A dog, an elephant or a dragon. trunk: meters from hips to neck, with legs of .5 m."""
    bones = {
        **chain(
            "Pelvis Spine Neck Head",
            None,
            (0, 0.6, -0.3),
            (0, 0.02, trunk / 2),
            (0, 0.08, trunk / 2),
            (0, 0.12, 0.15),
        ),
        **pair(arm, "Spine", (0.08, -0.08, 0.2), (0, -0.24, -0.03), (0, -0.24, 0.02)),
        **pair(
            leg, "Pelvis", (0.08, -0.05, 0), (0, -0.24, 0.06), (0, -0.24, -0.08), (0, -0.05, 0.06)
        ),
    }
    if tail:
        bones |= chain(f"{tail}1 {tail}2", "Pelvis", (0, 0.05, -0.1), (0, -0.05, -0.2))
    return {
        name: (above, (size * x, size * y, size * z)) for name, (above, (x, y, z)) in bones.items()
    }


def biped(
    leg: float = 0.84,
    arm: float = 0.53,
    extra: Bones | None = None,
    trunk_forward: float = 0.0,
    names: Mapping[str, str] = HUMAN_NAMES,
) -> Bones:
    """A person, or a body on two legs. leg, arm: meters. trunk_forward: the share of the trunk that
    leads forward instead of up."""
    up = float(np.sqrt(1 - trunk_forward**2))
    return {
        **chain(
            "Hips Spine Neck Head",
            None,
            (0, leg + 0.1, 0),
            (0, 0.25 * up, 0.25 * trunk_forward),
            (0, 0.25 * up, 0.25 * trunk_forward),
            (0, 0.12, 0.03),
        ),
        **pair(names["arm"], "Spine", (0.18, 0.18, 0), (arm / 2, 0, 0), (arm / 2, 0, 0)),
        **pair(
            names["leg"], "Hips",
            (0.1, -0.05, 0), (0, -leg / 2, 0), (0, -leg / 2, -0.01), (0, -0.05, 0.14),
        ),
        **(extra or {}),
    }  # fmt: skip


TAIL = chain("Tail1 Tail2 Tail3", "Hips", (0, 0.05, -0.1), (0, -0.05, -0.2), (0, -0.05, -0.2))


def many_legged(name: str) -> Bones:
    """A crab or a spider with eight legs. name: of the joints of leg {0} on the side {{}}."""
    bones = chain("Body Neck Head", None, (0, 0.3, 0), (0, 0.02, 0.15), (0, 0.02, 0.1))
    for leg in range(1, 5):
        joints = " ".join(f"{{}}_{name.format(leg)}{part}" for part in ("", "Mid", "Low", "Tip"))
        bones = {
            **bones,
            **pair(
                joints, "Body",
                (0.1, 0, 0.1 - 0.06 * leg), (0.2, 0.1, 0), (0.15, -0.2, 0), (0.05, -0.15, 0),
            ),
        }  # fmt: skip
    return bones


ANIMALS: dict[str, Recording] = {
    "dog with human names": moving(four_legged(**HUMAN_NAMES, tail="Tail")),
    "dog without a tail": moving(four_legged(**HUMAN_NAMES)),
    "dog with names of its own": moving(
        four_legged(
            "{}_FrontLeg {}_FrontKnee {}_FrontPaw",
            "{}_HindLeg {}_HindKnee {}_HindHeel {}_HindPaw",
            tail="Tail",
        )
    ),
    "horse of Biped": moving(
        four_legged("{}_UpperArm {}_Forearm {}_Hand", "{}_Thigh {}_Calf {}_HorseLink {}_Foot")
    ),
    "elephant": moving(four_legged(**HUMAN_NAMES, tail="Tail", size=4, trunk=0.6)),
    "dragon": moving(
        {
            **four_legged(**HUMAN_NAMES, tail="Tail", size=3, trunk=0.7),
            **pair("{}_Wing1 {}_Wing2", "Spine", (0.2, 0.3, 0), (0.9, 0.3, 0)),
        }
    ),
    "spider": moving(many_legged("Leg{}")),
    "crab with legs named like a person's": moving(
        {
            **many_legged("Limb{}"),
            **pair("{}_Claw1 {}_Claw2", "Body", (0.1, 0, 0.2), (0, 0, 0.2)),
        }
    ),
    "bird": moving(
        biped(
            leg=0.3, arm=0.6, extra=TAIL, trunk_forward=0.8,
            names=HUMAN_NAMES | {"arm": "{}_Wing1 {}_Wing2 {}_Wing3"},
        )
    ),
    "bird with human names": moving(biped(leg=0.3, arm=0.6, extra=TAIL, trunk_forward=0.85)),
    "dinosaur": moving(biped(leg=0.5, arm=0.2, extra=TAIL, trunk_forward=0.95)),
}  # fmt: skip

ANIMALS |= {
    f"{name} in a file of positions": without_rest(ANIMALS[name])
    for name in ("dog with human names", "elephant", "dragon", "bird", "spider")
}


def _crawling(leg: float, pitch: float = 80.0) -> Recording:
    """A person on hands and knees: the rest pose is upright and the root leans forward."""
    bones = biped(leg=leg)
    recording = moving(bones, pitch=pitch, height=0.1 - leg / 2)
    names = recording.skeleton.names
    rotations = recording.rotations
    assert rotations is not None
    angles: FloatArray = np.zeros((len(rotations), len(names), 3))
    swing = 0.15 * np.sin(np.linspace(0, 4 * np.pi, len(rotations)))
    angles[:, 0, 0] = np.radians(pitch)
    for side, sign in (("L", 1), ("R", -1)):
        angles[:, names.index(f"{side}_UpperArm"), 0] = sign * swing
        angles[:, names.index(f"{side}_UpperArm"), 1] = -sign * np.pi / 2
        angles[:, names.index(f"{side}_Thigh"), 0] = -np.radians(pitch) - sign * swing
        angles[:, names.index(f"{side}_Calf"), 0] = np.pi / 2
    turns = euler_to_quaternions(angles, "XYZ")
    roots = recording.positions[:, 0].astype(np.float64)
    skeleton = recording.skeleton
    positions = forward_kinematics(skeleton, turns, local_translations(skeleton, roots))
    return Recording(
        "bvh", skeleton, positions.astype(np.float32), turns.astype(np.float32), None, 30.0
    )


def _posed(angles: Mapping[str, tuple[float, float, float]], height: float) -> Recording:
    """A person with turned joints, in degrees, who sways a little."""
    recording = moving(biped(), speed=0, height=height)
    names, rotations = recording.skeleton.names, recording.rotations
    assert rotations is not None
    turns = np.array(rotations, dtype=np.float64)
    for name, angle in angles.items():
        turns[:, names.index(name)] = euler_to_quaternions(np.radians(angle), "XYZ")
    roots = recording.positions[:, 0].astype(np.float64)
    translations = local_translations(recording.skeleton, roots)
    positions = forward_kinematics(recording.skeleton, turns, translations)
    return replace(
        recording, positions=positions.astype(np.float32), rotations=turns.astype(np.float32)
    )


def _sitting(seat: float) -> Recording:
    """A person whose thighs are level. seat: the height of the hips in meters."""
    bend = 90 if seat > 0.3 else 0
    legs = {f"{side}_Thigh": (-90.0, 0.0, 0.0) for side in "LR"}
    legs |= {f"{side}_Calf": (float(bend), 0.0, 0.0) for side in "LR"}
    return _posed(legs, seat - 0.94)


def _turning() -> Recording:
    """A person who turns sideways over hands and feet again and again."""
    recording = moving(biped(), frames=90)
    assert recording.rotations is not None
    turns = np.array(recording.rotations, dtype=np.float64)
    angles: FloatArray = np.zeros((90, 3))
    angles[:, 2] = np.linspace(0, 6 * np.pi, 90)
    turns[:, 0] = euler_to_quaternions(angles, "XYZ")
    roots = recording.positions[:, 0].astype(np.float64)
    translations = local_translations(recording.skeleton, roots)
    positions = forward_kinematics(recording.skeleton, turns, translations)
    return replace(
        recording, positions=positions.astype(np.float32), rotations=turns.astype(np.float32)
    )


PEOPLE: dict[str, Recording] = {
    "walking": moving(biped()),
    "crawling": _crawling(0.84),
    "crawling in a file of positions": without_rest(_crawling(0.84)),
    "crawling child": _crawling(0.6),
    "on hands and feet": moving(biped(), pitch=100),
    "turning cartwheels": _turning(),
    "sitting on a chair": _sitting(0.45),
    "sitting on the floor": _sitting(0.1),
    "standing on the hands": moving(biped(), pitch=180, speed=0),
    "lying": moving(biped(), pitch=90, height=-0.85, speed=0),
    "cartoon with short legs": moving(biped(leg=0.44)),
    "cartoon with short legs and a tail": moving(biped(leg=0.44, extra=TAIL)),
    "in a costume with wings and a tail": moving(
        biped(
            extra={
                **TAIL,
                **pair("{}_Wing1 {}_Wing2 {}_Wing3", "Spine", (0.1, 0.2, -0.1), (0.4, 0.2, 0),
                       (0.4, 0, 0)),
            }
        )
    ),
    "with hair in a tail": moving(
        biped(extra=chain("PonyTail1 PonyTail2", "Head", (0, 0.1, -0.1), (0, -0.2, 0)))
    ),
}  # fmt: skip
