"""Positions as a C3D file: a point is a joint.

The axes are usual for laboratories: Z up, X as it is, right-handed; POINT:X_SCREEN and Y_SCREEN say
so. Numbers are 32-bit floats. Source: "The C3D file format user guide" (Motion Lab Systems 2008).

Our own writer: ezc3d 1.7 loses all frames after 65,535 (9 minutes at 120 Hz), takes 580 MB for a
file of 34 MB, and writes to named files only. It reads our files in the tests.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from app.formats.common.marker_labels import marker_labels
from app.numerics.arrays import FloatArray

BLOCK = 512
"""Bytes: the sections of a file begin at multiples of it."""

BLOCK_FRAMES = 1024
MAX_SHORT = 65535
"""The largest number in 16 bits. A longer motion says its length in TRIAL:ACTUAL_END_FIELD."""

LABELS_AT_ONCE = 255
"""Labels of one parameter. More go on in LABELS2, LABELS3, ..."""

SMALLEST = 1e-4
"""In the file's unit. A point at the origin is moved by so much: many programs take zeros for a
point that no camera saw."""

_INTEL = 84
_KEY = 80
_Value = int | float | str | Sequence[int] | Sequence[str]


def write_c3d(
    names: Sequence[str],
    positions: FloatArray,
    frame_rate: float,
    *,
    unit: str = "mm",
    units_per_meter: float = 1000.0,
) -> Iterator[bytes]:
    """A C3D file of positions (frames, joints, 3) in meters, Y up, piece by piece.

    names: (joints,); labels are made of them by `marker_labels`. frame_rate: Hz. unit: its name in
    the file.
    """
    frames, points = positions.shape[:2]
    parameters = _parameters(marker_labels(names), frames, frame_rate, unit)
    yield _header(points, frames, frame_rate, 2 + len(parameters) // BLOCK) + parameters
    size = 0
    for start in range(0, frames, BLOCK_FRAMES):
        block = _points(positions[start : start + BLOCK_FRAMES], units_per_meter)
        size += len(block)
        yield block
    yield bytes(-size % BLOCK)


def _points(positions: FloatArray, scale: float) -> bytes:
    """x, y, z and a residual of 0 (seen), as 32-bit floats; Y up becomes Z up."""
    x, y, z = np.moveaxis(positions.astype(np.float64) * scale, -1, 0)
    values = np.stack([x, -z, y, np.zeros_like(x)], axis=-1).astype("<f4")
    at_origin = ~values[..., :3].any(axis=-1)
    values[at_origin, 0] = SMALLEST
    return values.tobytes()


def _header(points: int, frames: int, rate: float, data_block: int) -> bytes:
    last = min(frames, MAX_SHORT)
    words = struct.pack("<BBHHHHH", 2, _KEY, points, 0, 1, last, 0)
    return (words + struct.pack("<fHHf", -1.0, data_block, 0, rate)).ljust(BLOCK, b"\x00")


def _parameters(labels: Sequence[str], frames: int, rate: float, unit: str) -> bytes:
    """The parameter section, with the number of its blocks in the third byte."""
    groups = _groups(labels, frames, rate, unit)
    # four bytes before the section, and two zeros that end it
    blocks = -(-(len(_section(groups)) + 4 + 2) // BLOCK)
    groups["POINT"]["DATA_START"] = 2 + blocks
    start = bytes([1, _KEY, blocks, _INTEL])
    return (start + _section(groups)).ljust(blocks * BLOCK, b"\x00")


def _section(groups: Mapping[str, Mapping[str, _Value]]) -> bytes:
    return b"".join(
        _group(number, name) + b"".join(_parameter(number, *one) for one in values.items())
        for number, (name, values) in enumerate(groups.items(), 1)
    )


def _groups(
    labels: Sequence[str], frames: int, rate: float, unit: str
) -> dict[str, dict[str, _Value]]:
    point: dict[str, _Value] = {
        "USED": len(labels), "SCALE": -1.0, "RATE": float(rate), "DATA_START": 0,
        "FRAMES": min(frames, MAX_SHORT), "UNITS": unit, "X_SCREEN": "+X", "Y_SCREEN": "+Z",
    }  # fmt: skip
    for number, start in enumerate(range(0, len(labels), LABELS_AT_ONCE), 1):
        some = labels[start : start + LABELS_AT_ONCE]
        ending = str(number) if number > 1 else ""
        point |= {f"LABELS{ending}": some, f"DESCRIPTIONS{ending}": ["joint center"] * len(some)}
    trial: dict[str, _Value] = {
        "ACTUAL_START_FIELD": [1, 0],
        "ACTUAL_END_FIELD": [frames % 2**16, frames // 2**16],
        "CAMERA_RATE": float(rate),
    }
    return {
        "POINT": point,
        "ANALOG": {"USED": 0, "GEN_SCALE": 1.0, "RATE": float(rate)},
        "FORCE_PLATFORM": {"USED": 0},
        "TRIAL": trial,
        "MANUFACTURER": {"SOFTWARE": "Kinedex"},
    }


def _group(number: int, name: str) -> bytes:
    return struct.pack("<bb", len(name), -number) + name.encode() + struct.pack("<hB", 3, 0)


def _parameter(group: int, name: str, value: _Value) -> bytes:
    kind, shape, raw = _encoded(value)
    body = struct.pack("<bB", kind, len(shape)) + bytes(shape) + raw + b"\x00"
    start = struct.pack("<bb", len(name), group) + name.encode()
    return start + struct.pack("<h", len(body) + 2) + body


def _encoded(value: _Value) -> tuple[int, list[int], bytes]:
    """The type of a parameter, its dimensions, and its bytes."""
    if isinstance(value, str):
        return -1, [len(value)], value.encode()
    if isinstance(value, float):
        return 4, [], struct.pack("<f", value)
    if isinstance(value, int):
        return 2, [], struct.pack("<H", value)
    if value and isinstance(value[0], str):
        texts = [str(text) for text in value]
        width = max(map(len, texts))
        return -1, [width, len(texts)], "".join(text.ljust(width) for text in texts).encode()
    return 2, [len(value)], struct.pack(f"<{len(value)}H", *value)
