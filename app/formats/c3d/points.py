"""The points of a C3D file: header, frame count, and the numbers of each frame.

Source: "The C3D file format user guide" (Motion Lab Systems 2008), chapters 3 and 6.
Analog channels stand between the frames and are skipped, whatever the parameters say of them.
What the file declares is compared with the number of its bytes before any frame is read.
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

FULL_COUNT = 65535
"""The number of the last frame in the header if 16 bits are too few for it."""
NO_SCALE = 1e-12


@dataclass(frozen=True, slots=True)
class Points:
    """labels: (points,) as in the file, empty where there is none; positions: (frames,
    points, 3) float32 in the file's unit and axes, NaN where a point was not seen;
    first_frame: the number of the first frame; frame_rate: Hz or None."""

    labels: tuple[str, ...]
    positions: FloatArray
    first_frame: int
    frame_rate: float | None
    parameters: Parameters
    cautions: tuple[Caution, ...]


@dataclass(frozen=True, slots=True)
class _Header:
    points: int
    analogue: int
    first: int
    last: int
    scale: float
    data_block: int
    rate: float


def read_points(content: bytes) -> Points:
    """Read a C3D file's points. Raises Unreadable naming the byte, and TooLarge."""
    if len(content) < BLOCK:
        raise unreadable_byte(len(content), f"expected a header of {BLOCK} bytes, found the end")
    numbers, parameters = read_parameters(content)
    header = _header(content, numbers)
    if not header.points:
        raise unreadable_byte(2, "expected points, found none")
    width = 2 if header.scale > 0 else 4
    frame_bytes = width * (4 * header.points + header.analogue)
    start = (header.data_block - 1) * BLOCK
    room = max(0, len(content) - start) // frame_bytes if start > 0 else 0
    frames, cautions = _frame_count(header, parameters, room, start)
    if frames * header.points > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} points times frames")
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
    if not NO_SCALE < abs(scale) < MAX_MAGNITUDE:
        raise unreadable_byte(12, f"expected a scale factor, found {scale:g}")
    return _Header(word(2), word(3), word(4), word(5), scale, word(9), real(11))


def _frame_count(
    header: _Header, parameters: Parameters, room: int, start: int
) -> tuple[int, tuple[Caution, ...]]:
    """The number of frames to read, and a caution if more are declared.

    The 16 bits of the header are too few for a long motion, so the parameters count as well.
    room: how many frames the file has bytes for, from the byte `start` on. Raises Unreadable.
    """
    declared = _declared_counts(header, parameters)
    held = [count for count in declared if count <= room]
    if not held:
        least = min(declared) if declared else 1
        message = f"expected {least} frames, found {room}: the file is cut short"
        raise unreadable_byte(start, message)
    frames = max(held)
    if frames == max(declared):
        return frames, ()
    detail = f"the file declares {max(declared)} frames and holds {frames}"
    return frames, (Caution("frames_mismatch", detail),)


def _declared_counts(header: _Header, parameters: Parameters) -> list[int]:
    """The numbers of frames that the header and the parameters declare; empty if none does."""
    every = (
        _count_of_header(header),
        _count_of_points(parameters),
        _count_of_trial(parameters),
    )
    counts = [count for count in every if count is not None and 0 < count != FULL_COUNT]
    if not counts and header.last == FULL_COUNT:
        return [FULL_COUNT - header.first + 1]
    return counts


def _count_of_header(header: _Header) -> int | None:
    if header.last < header.first or header.last == FULL_COUNT:
        return None
    return header.last - header.first + 1


def _count_of_points(parameters: Parameters) -> int | None:
    declared = parameters.get("POINT:FRAMES")
    if declared is None or declared.first is None or not np.isfinite(declared.first):
        return None
    count = int(declared.first)
    # Above 32,767 the sign of the 16-bit integer is wrong.
    return count % 2**16 if count < 0 else count


def _count_of_trial(parameters: Parameters) -> int | None:
    start, end = (parameters.get(f"TRIAL:ACTUAL_{name}_FIELD") for name in ("START", "END"))
    if start is None or end is None or min(len(start.values), len(end.values)) < 2:
        return None
    return _joined(end.values) - _joined(start.values) + 1


def _joined(halves: tuple[float, ...]) -> int:
    """A 32-bit number written as two 16-bit ones, the low one first."""
    return int(halves[0]) % 2**16 + 2**16 * (int(halves[1]) % 2**16)


def _positions(raw: bytes, header: _Header, numbers: Numbers, frames: int) -> FloatArray:
    """(frames, points, 3): x, y, z where the fourth number says that the point was seen."""
    shape = (frames, header.points, 4)
    if header.scale > 0:
        values = numbers.integers(raw).reshape(shape)
        positions = (values[..., :3] * header.scale).astype(np.float32)
    else:
        values = numbers.floats(raw).reshape(shape)
        positions = values[..., :3].copy()
    # NaN, zeros for all three, and a residual of -1 all mean that no camera saw it.
    with np.errstate(invalid="ignore"):
        seen = (np.abs(positions) <= MAX_MAGNITUDE).all(axis=-1) & (values[..., 3] >= 0)
        seen &= (positions != 0).any(axis=-1)
    positions[~seen] = np.nan
    return positions


def _labels(parameters: Parameters, points: int) -> tuple[str, ...]:
    """(points,): more than 255 labels go on in LABELS2, LABELS3, ..."""
    labels: list[str] = []
    for number in range(1, points // 255 + 2):
        more = parameters.get(f"POINT:LABELS{number if number > 1 else ''}")
        labels += more.texts if more is not None else ()
    return tuple(labels[:points]) + ("",) * (points - len(labels))


def _rate(header: _Header, parameters: Parameters) -> float | None:
    said = parameters.get("POINT:RATE")
    for rate in (said.first if said is not None else None, header.rate):
        if rate is not None and FRAME_RATES[0] <= rate <= FRAME_RATES[1]:
            return float(np.float32(rate))
    return None
