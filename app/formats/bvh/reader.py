"""Reads Biovision hierarchy (BVH) files in all known dialects.

Bytes in, Recording out. A position channel of any joint replaces its OFFSET along that axis, unless
all position channels of a joint below a root are 0 in every frame: some programs write such
channels and mean the OFFSET. Rotation channels turn in the order in which they are listed. Source:
Meredith and Maddock, "Motion capture file formats explained" (2001).
"""

from __future__ import annotations

import re

import numpy as np

from app.formats.bvh.frames import read_frames
from app.formats.bvh.hierarchy import Channel, Hierarchy, read_hierarchy
from app.formats.common.failures import unreadable_line
from app.formats.common.lines import with_plain_newlines
from app.formats.common.world_positions import Solved, solve
from app.motion.skeleton.recording import Caution, Recording
from app.motion.skeleton.rotations import euler_to_quaternions, identity_quaternions
from app.numerics.arrays import FloatArray

_MOTION = re.compile(rb"^[ \t]*MOTION[ \t]*(?::[ \t]*)?$", re.IGNORECASE | re.MULTILINE)

MAX_NAMED = 5
"""The most joints that a caution names."""


def read_bvh(content: bytes) -> Recording:
    """Read a BVH file.

    Units and axes are those of the file. Raises Unreadable with the line, and TooLarge. If the
    frame time is impossible, `frame_rate` is None, with a caution.
    """
    text = with_plain_newlines(content)
    motion = _MOTION.search(text)
    hierarchy = read_hierarchy(text[: motion.start()] if motion else text)
    if motion is None:
        raise unreadable_line(text.count(b"\n") + 1, "expected MOTION, found the end of the file")
    if not hierarchy.channels:
        raise unreadable_line(1, "expected channels on some joint, found none")
    first_line = text.count(b"\n", 0, motion.end()) + 2
    frames = read_frames(text[motion.end() + 1 :], first_line, len(hierarchy.channels))
    unused = _unused_joints(hierarchy, frames.numbers)
    solved = _solve(hierarchy, frames.numbers, unused)
    return Recording(
        format="bvh",
        skeleton=hierarchy.skeleton,
        positions=solved.positions,
        rotations=solved.rotations,
        translations=solved.translations,
        frame_rate=frames.frame_rate,
        cautions=hierarchy.cautions + frames.cautions + _unused_caution(hierarchy, unused),
    )


def _unused_joints(hierarchy: Hierarchy, numbers: FloatArray) -> frozenset[int]:
    """The joints below a root whose position channels are all 0, but not their OFFSETs.

    numbers: (frames, channels).
    """
    skeleton = hierarchy.skeleton
    columns: dict[int, list[int]] = {}
    for column, channel in enumerate(hierarchy.channels):
        if channel.is_position and skeleton.parents[channel.joint] >= 0:
            columns.setdefault(channel.joint, []).append(column)
    return frozenset(
        joint
        for joint, its in columns.items()
        if skeleton.offsets[joint].any() and not numbers[:, its].any()
    )


def _unused_caution(hierarchy: Hierarchy, unused: frozenset[int]) -> tuple[Caution, ...]:
    if not unused:
        return ()
    names = ", ".join(hierarchy.skeleton.names[joint] for joint in sorted(unused)[:MAX_NAMED])
    more = f" and {len(unused) - MAX_NAMED} more" if len(unused) > MAX_NAMED else ""
    detail = f"position channels that are 0 in every frame are not used: {names}{more}"
    joint = hierarchy.skeleton.names[min(unused)]
    return (Caution("position_channels_unused", detail, joint=joint),)


def _solve(hierarchy: Hierarchy, numbers: FloatArray, unused: frozenset[int]) -> Solved:
    """unused: the joints whose position channels are not used."""

    def local_pose(block: slice) -> tuple[FloatArray, FloatArray]:
        rows = numbers[block]
        return _local_rotations(hierarchy, rows), _local_translations(hierarchy, rows, unused)

    moving = any(
        c.is_position and hierarchy.skeleton.parents[c.joint] >= 0 and c.joint not in unused
        for c in hierarchy.channels
    )
    return solve(hierarchy.skeleton, len(numbers), local_pose, moving=moving)


def _local_translations(
    hierarchy: Hierarchy, numbers: FloatArray, unused: frozenset[int]
) -> FloatArray:
    """(frames, joints, 3) the offsets, or the position channels; numbers: (frames, channels)."""
    offsets = hierarchy.skeleton.offsets
    result = np.broadcast_to(offsets, (len(numbers), *offsets.shape)).copy()
    for column, channel in enumerate(hierarchy.channels):
        if channel.is_position and channel.joint not in unused:
            result[:, channel.joint, channel.axis] = numbers[:, column]
    return result


def _local_rotations(hierarchy: Hierarchy, numbers: FloatArray) -> FloatArray:
    """(frames, joints, 4) the local quaternions; numbers: (frames, channels) in degrees.

    Joints whose channels turn in the same order are computed together.
    """
    result = identity_quaternions((len(numbers), len(hierarchy.skeleton)))
    for order, joints, columns in _rotation_groups(hierarchy.channels):
        angles = np.radians(numbers[:, columns])  # (frames, joints of the group, axes)
        result[:, joints] = euler_to_quaternions(angles, order)
    return result


def _rotation_groups(
    channels: tuple[Channel, ...],
) -> list[tuple[str, list[int], list[list[int]]]]:
    """Each order of rotation, the joints that have it, and their columns (joints, axes)."""
    by_joint: dict[int, list[int]] = {}
    for column, channel in enumerate(channels):
        if not channel.is_position:
            by_joint.setdefault(channel.joint, []).append(column)
    groups: dict[str, tuple[list[int], list[list[int]]]] = {}
    for joint, columns in by_joint.items():
        order = "".join("XYZ"[channels[column].axis] for column in columns)
        group = groups.setdefault(order, ([], []))
        group[0].append(joint)
        group[1].append(columns)
    return [(order, joints, columns) for order, (joints, columns) in groups.items()]
