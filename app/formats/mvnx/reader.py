"""Reads MVNX files of Xsens MVN: bytes in, Recording out.

Each frame has the positions and the orientations of all segments in the world: meters, Z up. A
segment's frame has the axes of the world in the frame of the kind `identity`, which is the rest
pose. The frames of calibration (`identity`, `tpose`, `npose`, ...) are not motion. Fingers are not
read. Source: Xsens, "MVN user manual", section 23 (MVNX).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from app.formats.common.decimals import plain_table
from app.formats.common.failures import too_large, unreadable_at, unreadable_line
from app.formats.common.names import MAX_NAME_LENGTH
from app.formats.common.numbers import check_magnitudes, parse_any_numbers
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.formats.mvnx.document import Document, Frame, read_document
from app.motion.skeleton.recording import FRAME_RATES, Caution, Recording
from app.motion.skeleton.rotations import conjugate, identity_quaternions, multiply, rotate
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray, IntArray

MIN_NORM = 1e-6
"""A quaternion with a smaller norm is no turn."""
_SPINE = ("Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head")
_LIMBS = (
    ("T8", "?Shoulder", "?UpperArm", "?ForeArm", "?Hand"),
    ("Pelvis", "?UpperLeg", "?LowerLeg", "?Foot", "?Toe"),
)
_CHAINS = (
    _SPINE,
    *(
        tuple(name.replace("?", side) for name in limb)
        for limb in _LIMBS
        for side in ("Right", "Left")
    ),
)
PARENTS: dict[str, str] = {lower: upper for chain in _CHAINS for upper, lower in pairwise(chain)}
"""The segment above each segment of the body, for files without joints."""


def read_mvnx(content: bytes) -> Recording:
    """Read an MVNX file. Raises Unreadable with the line, and TooLarge."""
    document = read_document(content)
    names = [name[:MAX_NAME_LENGTH] for name in document.segments]
    frames = [frame for frame in document.frames if frame.kind == "normal"]
    if not names:
        raise unreadable_at("segments", "expected segments of a body, found none")
    if not frames:
        raise unreadable_at("frames", "expected frames of the type normal, found none")
    if len(frames) * len(names) > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} segments times frames")
    parents, order = _tree(document, names)
    positions = _numbers(frames, "position", len(names), 3)[:, order]
    turned = _turned(frames, len(names))
    world = None if turned is None else turned[:, order]
    offsets = _offsets(document, positions, world, parents, order)
    return Recording(
        format="mvnx",
        skeleton=Skeleton(tuple(names[index] for index in order), parents, offsets),
        positions=positions.astype(np.float32),
        rotations=None if world is None else _local(world, parents).astype(np.float32),
        translations=None if world is None else _translations(positions, world, parents),
        frame_rate=_frame_rate(document),
        up_axis="z",
        is_up_axis_said=True,
        metres_per_unit=1.0,
        cautions=_cautions(document),
    )


def _tree(document: Document, names: Sequence[str]) -> tuple[IntArray, IntArray]:
    """(segments,) parents in the new order, and the old index of each segment in it.

    Raises Unreadable if a segment is its own ancestor.
    """
    index = {name: number for number, name in reversed(list(enumerate(names)))}
    pairs = document.joints or [(upper, lower) for lower, upper in PARENTS.items()]
    above = np.full(len(names), -1, dtype=np.int64)
    for upper, lower in pairs:
        if upper in index and lower in index:
            above[index[lower]] = index[upper]
    order: list[int] = []
    waiting = [number for number in reversed(range(len(names))) if above[number] < 0]
    while waiting:
        order.append(waiting.pop())
        waiting += np.flatnonzero(above == order[-1]).tolist()[::-1]
    if len(order) < len(names):
        raise unreadable_at("joints", "expected a tree, found a segment that is its own ancestor")
    new_index = np.empty(len(names) + 1, dtype=np.int64)
    new_index[order] = np.arange(len(names))
    new_index[-1] = -1  # the parent -1 indexes the last element
    return new_index[above[order]], np.array(order, dtype=np.int64)


def _numbers(frames: Sequence[Frame], part: str, segments: int, width: int) -> FloatArray:
    """(frames, segments, width) float64. Raises Unreadable with the line."""
    texts: list[bytes] = [getattr(frame, part) for frame in frames]
    missing = next((frame for frame, text in zip(frames, texts, strict=True) if not text), None)
    if missing is not None:
        found = f"expected the {part} of segments, found none: export it from MVN"
        raise unreadable_line(missing.line, found)
    table = plain_table(texts, segments * width)
    if table is None:
        rows = [_row(frame, getattr(frame, part), segments * width) for frame in frames]
        table = np.stack(rows)
    check_magnitudes(table, [frame.line for frame in frames])
    return table.reshape(len(frames), segments, width)


def _row(frame: Frame, text: bytes, count: int) -> FloatArray:
    numbers = parse_any_numbers(text, frame.line)
    if len(numbers) != count:
        raise unreadable_line(frame.line, f"expected {count} numbers, found {len(numbers)}")
    return numbers


def _turned(frames: Sequence[Frame], segments: int) -> FloatArray | None:
    """(frames, segments, 4) unit quaternions w x y z in the world; None if the file has none."""
    if not any(frame.orientation for frame in frames):
        return None
    numbers = _numbers(frames, "orientation", segments, 4)
    norms = np.linalg.norm(numbers, axis=-1, keepdims=True)
    return np.where(norms > MIN_NORM, numbers / np.maximum(norms, MIN_NORM), [1.0, 0, 0, 0])


def _local(world: FloatArray, parents: IntArray) -> FloatArray:
    above = np.where(
        (parents >= 0)[:, None], world[:, np.maximum(parents, 0)], identity_quaternions(())
    )
    return multiply(conjugate(above), world)


def _translations(positions: FloatArray, world: FloatArray, parents: IntArray) -> FloatArray:
    """(frames, segments, 3) float32 the segments' origins in the frames of their parents."""
    below = np.flatnonzero(parents >= 0)
    above = parents[below]
    result = positions.copy()
    result[:, below] = rotate(conjugate(world[:, above]), positions[:, below] - positions[:, above])
    return result.astype(np.float32)


def _offsets(
    document: Document,
    positions: FloatArray,
    world: FloatArray | None,
    parents: IntArray,
    order: IntArray,
) -> FloatArray:
    """(segments, 3) from the frame of the kind identity, else the median over time."""
    identity = [frame for frame in document.frames if frame.kind == "identity" and frame.position]
    if identity:
        rest = _numbers(identity[:1], "position", len(order), 3)[0, order]
        return _from_parents(rest, parents)
    if world is not None:
        return np.asarray(np.median(_translations(positions, world, parents), axis=0), np.float64)
    return _from_parents(positions[0], parents)


def _from_parents(positions: FloatArray, parents: IntArray) -> FloatArray:
    """(segments, 3) the positions (segments, 3) relative to those of the parents."""
    above = np.where((parents >= 0)[:, None], positions[np.maximum(parents, 0)], 0.0)
    return np.asarray(positions - above)


def _frame_rate(document: Document) -> float | None:
    try:
        rate = float(document.frame_rate)
    except ValueError:
        return None
    return rate if FRAME_RATES[0] <= rate <= FRAME_RATES[1] else None


def _cautions(document: Document) -> tuple[Caution, ...]:
    first, *others = document.subjects or [""]
    if not others:
        return ()
    shown = ", ".join(name[:40] or "without a name" for name in others[:5])
    detail = f"only subject {first[:40] or 'without a name'} is read, not: {shown}"
    return (Caution("several_subjects", detail),)
