"""A small chain of swaying bones as FBX files, shared by the FBX tests."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from app.motion.skeleton.kinematics import forward_kinematics, local_translations
from app.motion.skeleton.recording import Recording
from app.numerics.arrays import FloatArray
from tests.formats.fbx.files import Bone, Curve, Curves, Take, fbx
from tests.formats.fbx.twin import world_positions
from tests.people import BODY, CONVENTIONS, ROLES

Animated = Mapping[tuple[int, str], FloatArray]
CHAIN = [
    Bone("Hips", -1, {"Lcl Translation": (1.0, 90.0, 2.0)}),
    Bone("Spine", 0, {"Lcl Translation": (0.0, 20.0, 3.0)}),
    Bone("Head", 1, {"Lcl Translation": (1.0, 15.0, 0.0)}),
]
FRAMES = 6
SWAY: dict[tuple[int, str], FloatArray] = {
    (0, "Lcl Translation"): np.linspace([1, 90, 2], [30, 80, -5], FRAMES),
    (0, "Lcl Rotation"): np.linspace([0, 0, 0], [10, 70, -40], FRAMES),
    (1, "Lcl Rotation"): np.linspace([5, -20, 0], [60, 30, 100], FRAMES),
}


def curves(animated: Animated, rate: float = 30.0) -> Curves:
    """Linear keys at each frame."""
    return {
        key: {
            axis: Curve([i / rate for i in range(len(values))], values[:, column].tolist())
            for column, axis in enumerate("XYZ")
        }
        for key, values in animated.items()
    }


def clip(
    bones: Sequence[Bone] = CHAIN, animated: Animated = SWAY, rate: float = 30.0, **traits: Any
) -> bytes:
    traits.setdefault("settings", {"TimeMode": 6, "UnitScaleFactor": 1.0})
    return fbx(bones, [Take("walk", [curves(animated, rate)])], **traits)


def expected(bones: Sequence[Bone], animated: Animated = SWAY) -> FloatArray:
    """(frames, bones, 3) the positions by the slow twin."""
    frames = max(len(values) for values in animated.values())
    return np.array(
        [
            world_positions(bones, {key: values[i] for key, values in animated.items()})
            for i in range(frames)
        ]
    )


def consistent(recording: Recording) -> bool:
    """Whether rotations, translations and offsets give the positions."""
    assert recording.rotations is not None
    moved = recording.translations
    if moved is None:
        moved = local_translations(recording.skeleton, recording.positions[:, 0])
    solved = forward_kinematics(recording.skeleton, recording.rotations, moved)
    return bool(np.allclose(solved, recording.positions, atol=2e-3))


def changed(bone: int, properties: Mapping[str, Any]) -> list[Bone]:
    bones = list(CHAIN)
    bones[bone] = replace(bones[bone], properties={**bones[bone].properties, **properties})
    return bones


def person_bones(names: Mapping[Any, str]) -> list[Bone]:
    return [
        Bone(names[role], -1 if above is None else ROLES.index(above),
             {"Lcl Translation": tuple(100.0 * np.array(offset))})
        for role, above, offset in BODY
    ]  # fmt: skip


def person_takes(seconds: Mapping[str, float]) -> bytes:
    """A person with animations at 30 Hz; seconds: the duration of each, by its name."""
    takes = []
    for name, length in seconds.items():
        phase = np.linspace(0, 6 * length, round(30 * length) + 1)
        turn = np.outer(np.sin(phase), [10 * length, 20, 5])
        takes.append(Take(name, [curves({(1, "Lcl Rotation"): turn})]))
    bones = person_bones(CONVENTIONS["Mixamo"])
    return fbx(bones, takes, settings={"TimeMode": 6, "UnitScaleFactor": 1.0})


def turning(curve: Curve) -> Take:
    """A stack in which one curve turns the hips."""
    return Take("t", [{(0, "Lcl Rotation"): {"X": curve}}])


WALK = Take("walk", [curves(SWAY)])


def axis_system(coord: str, up: str, front: str) -> dict[str, int]:
    """The GlobalSettings of three axes, for example "-z"."""
    found = {}
    for name, axis in (("CoordAxis", coord), ("UpAxis", up), ("FrontAxis", front)):
        found[name] = "xyz".index(axis[-1])
        found[f"{name}Sign"] = -1 if axis.startswith("-") else 1
    return found


RIGHT_HANDED = [
    axis_system("x", "y", "z"),
    axis_system("x", "z", "-y"),
    axis_system("z", "x", "y"),
    axis_system("x", "-y", "-z"),
]
LEFT_HANDED = [axis_system("x", "y", "-z"), axis_system("x", "z", "y")]
