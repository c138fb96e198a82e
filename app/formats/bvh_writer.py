"""Writing BVH files: a skeleton and its local rotations to bytes.

The root has six channels (position, then rotation), every other joint three.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from app.motion.rotations import quaternions_to_euler
from app.motion.skeleton import Skeleton
from app.numerics.arrays import FloatArray

DECIMALS = 6
"""Of positions (file units) and angles (degrees)."""


def write_bvh(
    skeleton: Skeleton,
    rotations: FloatArray,
    root_positions: FloatArray,
    frame_rate: float,
    rotation_order: str = "ZXY",
) -> bytes:
    """A BVH file of local quaternions (frames, joints, 4) and root positions (frames, 3).

    Offsets and positions in the file's unit; frame_rate in Hz; rotation_order holds each
    of X, Y, Z once. Where a skeleton has several roots, the first one moves and the others
    turn where they are.
    """
    angles = np.degrees(quaternions_to_euler(rotations, rotation_order))
    order = _depth_first(skeleton)
    lines = ["HIERARCHY", *_hierarchy(skeleton, order, rotation_order)]
    lines += ["MOTION", f"Frames: {len(rotations)}", f"Frame Time: {1 / frame_rate:.9g}"]
    numbers = np.concatenate([root_positions, angles[:, order].reshape(len(angles), -1)], axis=1)
    pattern = " ".join([f"%.{DECIMALS}f"] * numbers.shape[1])
    lines += [pattern % tuple(row) for row in numbers.tolist()]
    return ("\n".join(lines) + "\n").encode()


def _depth_first(skeleton: Skeleton) -> list[int]:
    """Joints in the order in which their blocks open."""
    found: list[int] = []
    waiting = [int(root) for root in np.flatnonzero(skeleton.parents < 0)[::-1]]
    while waiting:
        found.append(waiting.pop())
        waiting += reversed(skeleton.children(found[-1]))
    return found


def _hierarchy(skeleton: Skeleton, order: list[int], rotation_order: str) -> Iterator[str]:
    rotation = " ".join(f"{axis}rotation" for axis in rotation_order)
    open_joints: list[int] = []
    for joint in order:
        yield from _close(open_joints, int(skeleton.parents[joint]))
        indent = "  " * len(open_joints)
        keyword = "ROOT" if skeleton.parents[joint] < 0 else "JOINT"
        yield f"{indent}{keyword} {skeleton.names[joint]}"
        yield indent + "{"
        yield f"{indent}  OFFSET {_vector(skeleton.offsets[joint])}"
        moves = joint == order[0]
        position = "Xposition Yposition Zposition " if moves else ""
        yield f"{indent}  CHANNELS {6 if moves else 3} {position}{rotation}"
        yield from _end_sites(skeleton, joint, indent + "  ")
        open_joints.append(joint)
    yield from _close(open_joints, -1)


def _close(open_joints: list[int], until: int) -> Iterator[str]:
    """Close blocks until `until` is the innermost one that is open."""
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
