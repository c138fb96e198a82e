"""Reads Acclaim motion (AMC) files with their skeleton (ASF): bytes in, Recording out.

The local rotation of a bone is C M C^-1. C turns the world's axes to the axes of the bone. M is the
product of the channels' turns about fixed axes, in the order of the channels. The channels tx, ty
and tz move the start of the bone along the same axes, and l stretches the bone. Sources: see
`asf.py`.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from app.errors import SkeletonNeeded, Unreadable
from app.formats.acclaim.amc_frames import AmcFrames, read_amc_frames
from app.formats.acclaim.asf import AcclaimSkeleton, read_asf
from app.formats.acclaim.frame_order import USUAL_RATE, in_number_order
from app.formats.common.lines import with_plain_newlines
from app.formats.common.world_positions import solve
from app.kinedex_error import Place
from app.motion.skeleton.recording import Recording
from app.motion.skeleton.rotations import (
    conjugate,
    euler_to_quaternions,
    identity_quaternions,
    multiply,
    rotate,
)
from app.numerics.arrays import FloatArray


def read_amc(content: bytes, skeleton: bytes | None = None) -> Recording:
    """Read an AMC file with its ASF file.

    Raises SkeletonNeeded without an ASF file, Unreadable with the file and the line, and
    TooLarge. If the file gives no frame rate, `assumed_frame_rate` is the usual one.
    """
    if skeleton is None:
        raise SkeletonNeeded(places=[Place("skeleton", "expected the ASF file, found none")])
    body = _asf(skeleton)
    text = with_plain_newlines(content)
    frames = read_amc_frames(text, body.skeleton.names, body.channels)
    ordered = in_number_order(frames)
    numbers = _in_radians(body, frames, ordered.numbers)
    moving = any(c[0] == "t" or c == "l" for bone in body.channels[1:] for c in bone)

    def local_pose(block: slice) -> tuple[FloatArray, FloatArray]:
        rotations = _local_rotations(body, numbers[block])
        return rotations, _local_translations(body, numbers[block])

    solved = solve(body.skeleton, len(numbers), local_pose, moving=moving)
    return Recording(
        format="amc",
        skeleton=body.skeleton,
        positions=solved.positions,
        rotations=solved.rotations,
        translations=solved.translations,
        frame_rate=frames.frame_rate,
        metres_per_unit=body.metres_per_unit,
        cautions=body.cautions + frames.cautions + ordered.cautions,
        assumed_frame_rate=USUAL_RATE / ordered.step,
    )


def _asf(content: bytes) -> AcclaimSkeleton:
    """Read the skeleton. Its errors say that they are in the ASF file, not in the AMC file."""
    try:
        return read_asf(content)
    except Unreadable as problem:
        places = [Place(f"skeleton {place.location}", place.message) for place in problem.places]
        raise Unreadable(f"The skeleton cannot be read: {problem.detail}", places=places) from None


def _in_radians(body: AcclaimSkeleton, frames: AmcFrames, numbers: FloatArray) -> FloatArray:
    """`numbers` (frames, channels) with all turns in radians."""
    # The AMC file has priority, because its header describes its own numbers.
    in_degrees = body.in_degrees if frames.in_degrees is None else frames.in_degrees
    if not in_degrees:
        return numbers
    turns = np.array([channel[0] == "r" for bone in body.channels for channel in bone])
    return np.where(turns, np.radians(numbers), numbers)


def _local_rotations(body: AcclaimSkeleton, numbers: FloatArray) -> FloatArray:
    """(frames, joints, 4) the local rotations, float64.

    Joints that turn about the same axes in the same order are computed together.
    """
    result = identity_quaternions((len(numbers), len(body.channels)))
    for order, joints, columns in _turning_groups(body.channels):
        # angles (frames, joints of the group, axes of the order) -> turns (frames, joints, 4)
        axes = body.axes[joints]
        turned = euler_to_quaternions(numbers[:, columns], order)
        result[:, joints] = multiply(multiply(axes, turned), conjugate(axes))
    # The root has an orientation before it moves. All its turns are added to that.
    result[:, 0] = multiply(result[:, 0], body.orientation)
    return result


def _turning_groups(
    channels: Sequence[tuple[str, ...]],
) -> list[tuple[str, list[int], list[list[int]]]]:
    """Groups of joints with the same order of axes: the order, the joints, and their columns.

    The order names the outermost axis first. A file lists the axis that turns first, which is the
    innermost one, so the order is reversed here.
    """
    groups: dict[str, tuple[list[int], list[list[int]]]] = {}
    start = 0
    for joint, bone in enumerate(channels):
        turns = [(c[1].upper(), start + i) for i, c in enumerate(bone) if c[0] == "r"][::-1]
        start += len(bone)
        if turns:
            joints, columns = groups.setdefault("".join(axis for axis, _ in turns), ([], []))
            joints.append(joint)
            columns.append([column for _, column in turns])
    return [(order, joints, columns) for order, (joints, columns) in groups.items()]


def _local_translations(body: AcclaimSkeleton, numbers: FloatArray) -> FloatArray:
    """(frames, joints, 3) the local translations in the unit of the file.

    These are the offsets, moved along the bone's axes by tx, ty and tz. Where a bone is stretched,
    its children move outward.
    """
    offsets = body.skeleton.offsets
    result = np.broadcast_to(offsets, (len(numbers), *offsets.shape)).copy()
    start = 0
    for joint, bone in enumerate(body.channels):
        for column, channel in enumerate(bone, start):
            if channel[0] == "t":
                along = np.eye(3)["xyz".index(channel[1])]
                result[:, joint] += numbers[:, column, None] * rotate(body.axes[joint], along)
            elif channel == "l":
                children = body.skeleton.children(joint)
                stretched = numbers[:, column, None, None] * body.directions[joint]
                result[:, children] += stretched
        start += len(bone)
    return result
