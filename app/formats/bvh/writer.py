"""Writes BVH files from a skeleton and its local rotations and translations.

Joints that move relative to their parent have six channels (position, then rotation). The others
have three.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from app.motion.skeleton.rotations import quaternions_to_euler
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

DECIMALS = 6
"""Decimals of positions (in the file's unit) and of angles (degrees)."""
BLOCK_FRAMES = 1024
"""Frames that are converted to text at once."""


def write_bvh(
    skeleton: Skeleton,
    rotations: FloatArray,
    root_positions: FloatArray,
    frame_rate: float,
    rotation_order: str = "ZXY",
) -> bytes:
    """The bytes of a BVH file in which only the first root moves.

    skeleton: its offsets are in the unit of the file. rotations: (frames, joints, 4) local unit
    quaternions w x y z. root_positions: (frames, 3) in the unit of the file. frame_rate: Hz.
    rotation_order: each of X, Y, Z once. Other roots turn at their offsets.
    """
    order = _depth_first(skeleton)
    translations = np.repeat(skeleton.offsets[None].astype(np.float64), len(rotations), axis=0)
    translations[:, order[0]] = root_positions
    moving = order[:1]
    return b"".join(
        bvh_blocks(skeleton, rotations, translations, frame_rate, rotation_order, moving)
    )


def bvh_blocks(
    skeleton: Skeleton,
    rotations: FloatArray,
    translations: FloatArray,
    frame_rate: float,
    rotation_order: str,
    moving: Sequence[int],
) -> Iterator[bytes]:
    """The bytes of a BVH file, in blocks of frames.

    rotations: (frames, joints, 4) local unit quaternions w x y z. translations: (frames, joints, 3)
    local, in the unit of the file; only those of the joints `moving` are written, in place of the
    offsets. frame_rate: Hz. rotation_order: each of X, Y, Z once.
    """
    order = _depth_first(skeleton)
    head = ["HIERARCHY", *_hierarchy(skeleton, order, rotation_order, frozenset(moving))]
    head += ["MOTION", f"Frames: {len(rotations)}", f"Frame Time: {1 / frame_rate:.9g}"]
    yield ("\n".join(head) + "\n").encode()
    columns = _columns(order, frozenset(moving))
    pattern = " ".join([f"%.{DECIMALS}f"] * len(columns))
    for start in range(0, len(rotations), BLOCK_FRAMES):
        block = slice(start, start + BLOCK_FRAMES)
        angles = np.degrees(quaternions_to_euler(rotations[block], rotation_order))
        numbers = np.concatenate([translations[block], angles], axis=2)  # (n, joints, 6)
        rows = numbers.reshape(len(numbers), -1)[:, columns].tolist()
        yield ("\n".join(pattern % tuple(row) for row in rows) + "\n").encode()


def _columns(order: list[int], moving: frozenset[int]) -> list[int]:
    """The column of each channel of the file in rows of six numbers for each joint.

    The six numbers are the position and the angles.
    """
    first = {joint: 0 if joint in moving else 3 for joint in order}
    return [6 * joint + axis for joint in order for axis in range(first[joint], 6)]


def _depth_first(skeleton: Skeleton) -> list[int]:
    """The joints in the order in which their blocks open."""
    found: list[int] = []
    waiting = [int(root) for root in np.flatnonzero(skeleton.parents < 0)[::-1]]
    while waiting:
        found.append(waiting.pop())
        waiting += reversed(skeleton.children(found[-1]))
    return found


def _hierarchy(
    skeleton: Skeleton, order: list[int], rotation_order: str, moving: frozenset[int]
) -> Iterator[str]:
    rotation = " ".join(f"{axis}rotation" for axis in rotation_order)
    open_joints: list[int] = []
    for joint in order:
        yield from _close(open_joints, int(skeleton.parents[joint]))
        indent = "  " * len(open_joints)
        keyword = "ROOT" if skeleton.parents[joint] < 0 else "JOINT"
        yield f"{indent}{keyword} {skeleton.names[joint]}"
        yield indent + "{"
        yield f"{indent}  OFFSET {_vector(skeleton.offsets[joint])}"
        position = "Xposition Yposition Zposition " if joint in moving else ""
        yield f"{indent}  CHANNELS {6 if joint in moving else 3} {position}{rotation}"
        yield from _end_sites(skeleton, joint, indent + "  ")
        open_joints.append(joint)
    yield from _close(open_joints, -1)


def _close(open_joints: list[int], until: int) -> Iterator[str]:
    """Close blocks until joint `until` is the innermost open one; -1 closes all."""
    while open_joints and open_joints[-1] != until:
        open_joints.pop()
        yield "  " * len(open_joints) + "}"


def _end_sites(skeleton: Skeleton, joint: int, indent: str) -> Iterator[str]:
    for end in np.flatnonzero(skeleton.end_parents == joint):
        yield f"{indent}End Site"
        yield indent + "{"
        yield f"{indent}  OFFSET {_vector(skeleton.end_offsets[end])}"
        yield indent + "}"


def _vector(numbers: FloatArray) -> str:
    return " ".join(f"{number:.{DECIMALS}f}" for number in numbers)
