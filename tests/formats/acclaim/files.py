"""Writes ASF and AMC files for tests, and computes their positions slowly by 4x4 matrices."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.motion.roles.joint_roles import JointRole
from app.motion.skeleton.rotations import quaternions_to_euler
from app.numerics.arrays import FloatArray
from tests.people import BODY, CONVENTIONS, ROLES, person

Rows = list[list[list[float]]]
"""The numbers of the channels, by frame and bone."""


@dataclass(frozen=True)
class Bone:
    """A bone of an ASF file. The first bone of a list is the root; `parent` is an index."""

    name: str
    parent: int = -1
    direction: tuple[float, float, float] = (0, 1, 0)
    length: float = 0.0
    angles: tuple[float, float, float] = (0, 0, 0)
    order: str = "XYZ"
    channels: tuple[str, ...] = ()


ROOT = Bone("root", channels=("TX", "TY", "TZ", "RX", "RY", "RZ"))
ARM = (
    ROOT,
    Bone("upper", 0, (0, 1, 0), 8.0, (0, 0, 20), "XYZ", ("rx", "ry", "rz")),
    Bone("lower", 1, (1, 0, 0), 12.0, (10, 20, 30), "ZXY", ("rz", "rx")),
)
ARM_ROWS: Rows = [
    [[1, 2, 3, 0, 0, 0], [0, 0, 0], [0, 0]],
    [[4, 5, 6, 10, 20, 30], [40, 50, 60], [70, 80]],
]


def asf(bones: Sequence[Bone] = ARM, *, degrees: bool = True, length: float = 0.45) -> bytes:
    """An ASF file. Angles of `bones` are in degrees; the file has degrees or radians."""

    def turned(angles: Sequence[float]) -> str:
        return " ".join(f"{a if degrees else np.radians(a):.17g}" for a in angles)

    root = bones[0]
    lines = ["# made for a test", ":version 1.10", ":name test", ":units", "  mass 1.0"]
    lines += [f"  length {length}", f"  angle {'deg' if degrees else 'rad'}"]
    lines += [":documentation", "  any words: begin end name root", ":root"]
    lines += [f"  order {' '.join(root.channels)}", f"  axis {root.order}"]
    lines += ["  position 0 0 0", f"  orientation {turned(root.angles)}", ":bonedata"]
    for number, bone in enumerate(bones[1:], 1):
        direction = " ".join(f"{x:.17g}" for x in bone.direction)
        lines += ["  begin", f"    id {number}", f"    name {bone.name}"]
        lines += [f"    direction {direction}", f"    length {bone.length:.17g}"]
        lines += [f"    axis {turned(bone.angles)} {bone.order}"]
        if bone.channels:
            lines += [f"    dof {' '.join(bone.channels)}", "    limits (-160.0 20.0)"]
            lines += ["           (-inf inf)"] * (len(bone.channels) - 1)
        lines += ["  end"]
    lines += [":hierarchy", "  begin"]
    for index, bone in enumerate(bones):
        children = [child.name for child in bones[1:] if child.parent == index]
        if children:
            lines += [f"    {bone.name} {' '.join(children)}"]
    return "\n".join([*lines, "  end", ""]).encode()


def amc(
    bones: Sequence[Bone] = ARM, rows: Rows = ARM_ROWS, *, degrees: bool = True, first: int = 1
) -> bytes:
    """An AMC file. Turns in `rows` are in degrees; the file has degrees or radians."""
    lines = ["#!OML:ASF test.asf", ":FULLY-SPECIFIED", ":DEGREES" if degrees else ":RADIANS"]
    for number, row in enumerate(rows, first):
        lines += [str(number)]
        for bone, values in zip(bones, row, strict=True):
            pairs = zip(bone.channels, values, strict=True)
            numbers = [v if degrees or c[0] not in "rR" else np.radians(v) for c, v in pairs]
            if numbers:
                lines += [f"{bone.name} {' '.join(f'{v:.17g}' for v in numbers)}"]
    return "\n".join([*lines, ""]).encode()


def bone_starts(bones: Sequence[Bone], row: list[list[float]]) -> FloatArray:
    """(bones, 3) the start of each bone in one frame, by 4x4 matrices as in a textbook."""
    frames: list[FloatArray] = []
    stretches: list[float] = []
    for bone, values in zip(bones, row, strict=True):
        moves = {c.lower(): v for c, v in zip(bone.channels, values, strict=True)}
        turn = np.eye(4)
        for channel, value in moves.items():  # about fixed axes: later ones on the left
            if channel[0] == "r":
                turn = _turn(channel[1], value) @ turn
        shift = np.eye(4)
        shift[:3, 3] = [moves.get("tx", 0), moves.get("ty", 0), moves.get("tz", 0)]
        axes = np.eye(4)
        for axis in bone.order.lower():
            axes = _turn(axis, bone.angles["xyz".index(axis)]) @ axes
        if bone.parent < 0:
            frames.append(shift @ turn @ axes)
        else:
            above = bones[bone.parent]
            to_end = np.eye(4)
            direction = np.array(above.direction) / max(np.linalg.norm(above.direction), 1e-300)
            if bone.parent > 0:
                to_end[:3, 3] = direction * (above.length + stretches[bone.parent])
            local = axes @ shift @ turn @ np.linalg.inv(axes)
            frames.append(frames[bone.parent] @ to_end @ local)
        stretches.append(moves.get("l", 0.0))
    return np.array([frame[:3, 3] for frame in frames])


def _turn(axis: str, degrees: float) -> FloatArray:
    """The 4x4 matrix of a turn about an axis."""
    cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    j, k = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis.lower()]
    matrix = np.eye(4)
    matrix[j, j] = matrix[k, k] = cosine
    matrix[j, k], matrix[k, j] = -sine, sine
    return matrix


def acclaim_person(
    frames: int = 40, scale: float = 1 / 0.056444, seed: int = 0
) -> tuple[bytes, bytes, FloatArray]:
    """ASF, AMC and true positions (frames, roles, 3) in meters of the swaying person.

    A joint that is not at the end of its parent's bone gets one more bone, which does not move.
    """
    recording = person(frames=frames, seed=seed)
    names = CONVENTIONS["ASF"]
    bones, index = [ROOT], {JointRole.HIPS: 0}
    for role, above, offset in BODY[1:]:
        assert above is not None
        length = float(np.linalg.norm(offset))
        direction = (offset[0] / length, offset[1] / length, offset[2] / length)
        bones += [Bone(f"to{names[role]}", index[above], direction, length * scale)]
        bones += [Bone(names[role], len(bones) - 1, channels=("rx", "ry", "rz"))]
        index[role] = len(bones) - 1
    assert recording.rotations is not None
    # turns x, y, z about fixed axes are z, y, x about moving ones
    angles = np.degrees(quaternions_to_euler(recording.rotations.astype(float), "ZYX"))[..., ::-1]
    rows: Rows = [[[] for _ in bones] for _ in range(frames)]
    for frame, row in enumerate(rows):
        for joint, role in enumerate(ROLES):
            row[index[role]] = angles[frame, joint].tolist()
        row[0] = (recording.positions[frame, 0] * scale).tolist() + row[0]
    return asf(bones), amc(bones, rows), recording.positions
