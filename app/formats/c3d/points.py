"""Reads the points of a C3D file: the header, the number of frames, and the numbers of each frame.

The samples of analog channels follow the points of each frame and are skipped. The declared number
of frames is compared with the size of the file before any frame is read. Source: "The C3D file
format user guide" (Motion Lab Systems 2008), chapters 3 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.c3d.parameters import BLOCK, Numbers, Parameters, read_parameters
from app.formats.common.failures import too_large, unreadable_byte
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.motion.skeleton.recording import FRAME_RATES, Caution
from app.numerics.arrays import FloatArray

MAX_HEADER_FRAME = 65535
"""The last frame in the header if its true number does not fit in 16 bits."""
MIN_SCALE = 1e-12
"""A smaller scale factor counts as 0."""


@dataclass(frozen=True, slots=True)
class Points:
    """The points of a file, labeled or not.

    labels: (points,) as in the file, empty for a point without a label. positions: (frames, points,
    3) float32 in the unit and axes of the file, NaN where a point was not seen. first_frame: the
    number that the file gives to the first frame. frame_rate: Hz, None if the file gives none.
    """

    labels: tuple[str, ...]
    positions: FloatArray
    first_frame: int
    frame_rate: float | None
    parameters: Parameters
    cautions: tuple[Caution, ...]


@dataclass(frozen=True, slots=True)
class _Header:
    """The numbers of the header.

    points: of a frame. analog: all analog samples of a frame. first, last: numbers of frames.
    scale: positive for integers, negative for floats. data_block: counted from 1. rate: Hz.
    """

    points: int
    analog: int
    first: int
    last: int
    scale: float
    data_block: int
    rate: float


def read_points(content: bytes) -> Points:
    """Read the points of a C3D file. Raises Unreadable with the byte, and TooLarge."""
    if len(content) < BLOCK:
        raise unreadable_byte(len(content), f"expected a header of {BLOCK} bytes, found the end")
    numbers, parameters = read_parameters(content)
    header = _header(content, numbers)
    if not header.points:
        raise unreadable_byte(2, "expected points, found none")
    width = 2 if header.scale > 0 else 4
    frame_bytes = width * (4 * header.points + header.analog)
    start = (header.data_block - 1) * BLOCK
    # The number of whole frames for which the file has bytes.
    room = max(0, len(content) - start) // frame_bytes if start > 0 else 0
    frames, cautions = _frame_count(header, parameters, room, start)
    if frames * header.points > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} points times frames")
    # (frames, bytes of a frame) -> the bytes of the points alone, without analog samples
    raw = np.frombuffer(content, "u1", frames * frame_bytes, start).reshape(frames, frame_bytes)
    points = raw[:, : 4 * width * header.points].tobytes()
    return Points(
        labels=_labels(parameters, header.points),
        positions=_positions(points, header, numbers, frames),
        first_frame=header.first,
        frame_rate=_rate(header, parameters),
        parameters=parameters,
        cautions=cautions,
    )


def _header(content: bytes, numbers: Numbers) -> _Header:
    def word(index: int) -> int:
        return int(numbers.integers(content[2 * index - 2 : 2 * index])[0]) % 2**16

    def real(index: int) -> float:
        return float(numbers.floats(content[2 * index - 2 : 2 * index + 2])[0])

    scale = real(7)
    if not MIN_SCALE < abs(scale) < MAX_MAGNITUDE:
        raise unreadable_byte(12, f"expected a scale factor, found {scale:g}")
    return _Header(word(2), word(3), word(4), word(5), scale, word(9), real(11))


def _frame_count(
    header: _Header, parameters: Parameters, room: int, start: int
) -> tuple[int, tuple[Caution, ...]]:
    """The number of frames to read, and a caution if more are declared.

    The header has only 16 bits for the number of frames, so the parameters are used too. room: the
    number of frames for which the file has bytes, from the byte `start` on. Raises Unreadable if
    each declared number is larger.
    """
    declared = _declared_counts(header, parameters)
    possible = [count for count in declared if count <= room]
    if not possible:
        expected = min(declared) if declared else 1
        message = f"expected {expected} frames, found {room}: the file is cut short"
        raise unreadable_byte(start, message)
    frames = max(possible)
    if frames == max(declared):
        return frames, ()
    detail = f"the file declares {max(declared)} frames but has {frames}"
    return frames, (Caution("frames_mismatch", detail),)


def _declared_counts(header: _Header, parameters: Parameters) -> list[int]:
    """The numbers of frames that the header and the parameters declare; empty if none does."""
    candidates = (
        _count_of_header(header),
        _count_of_points(parameters),
        _count_of_trial(parameters),
    )
    counts = [count for count in candidates if count is not None and 0 < count != MAX_HEADER_FRAME]
    if not counts and header.last == MAX_HEADER_FRAME:
        return [MAX_HEADER_FRAME - header.first + 1]
    return counts


def _count_of_header(header: _Header) -> int | None:
    if header.last < header.first or header.last == MAX_HEADER_FRAME:
        return None
    return header.last - header.first + 1


def _count_of_points(parameters: Parameters) -> int | None:
    declared = parameters.get("POINT:FRAMES")
    if declared is None or declared.first is None or not np.isfinite(declared.first):
        return None
    count = int(declared.first)
    # Counts above 32,767 are read as negative, because 16-bit integers have a sign.
    return count % 2**16 if count < 0 else count


def _count_of_trial(parameters: Parameters) -> int | None:
    start, end = (parameters.get(f"TRIAL:ACTUAL_{name}_FIELD") for name in ("START", "END"))
    if start is None or end is None or min(len(start.values), len(end.values)) < 2:
        return None
    return _joined(end.values) - _joined(start.values) + 1


def _joined(halves: tuple[float, ...]) -> int:
    """The 32-bit number that is stored as two 16-bit numbers, the low one first."""
    return int(halves[0]) % 2**16 + 2**16 * (int(halves[1]) % 2**16)


def _positions(raw: bytes, header: _Header, numbers: Numbers, frames: int) -> FloatArray:
    """(frames, points, 3) float32 in the unit and axes of the file, NaN where not seen.

    raw: four numbers for each point of each frame: x, y, z and a residual.
    """
    shape = (frames, header.points, 4)
    if header.scale > 0:
        values = numbers.integers(raw).reshape(shape)
        positions = (values[..., :3] * header.scale).astype(np.float32)
    else:
        values = numbers.floats(raw).reshape(shape)
        positions = values[..., :3].copy()
    # A point was not seen if it has NaN, three zeros, or a negative residual.
    with np.errstate(invalid="ignore"):
        seen = (np.abs(positions) <= MAX_MAGNITUDE).all(axis=-1) & (values[..., 3] >= 0)
        seen &= (positions != 0).any(axis=-1)
    positions[~seen] = np.nan
    return positions


def _labels(parameters: Parameters, points: int) -> tuple[str, ...]:
    """(points,) the labels. The parameter LABELS has at most 255; LABELS2 and others follow."""
    labels: list[str] = []
    for number in range(1, points // 255 + 2):
        more = parameters.get(f"POINT:LABELS{number if number > 1 else ''}")
        labels += more.texts if more is not None else ()
    return tuple(labels[:points]) + ("",) * (points - len(labels))


def _rate(header: _Header, parameters: Parameters) -> float | None:
    parameter = parameters.get("POINT:RATE")
    for rate in (parameter.first if parameter is not None else None, header.rate):
        if rate is not None and FRAME_RATES[0] <= rate <= FRAME_RATES[1]:
            return float(np.float32(rate))
    return None
