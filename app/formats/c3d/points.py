"""Reads the points of a C3D file: the header, the number of frames, and the numbers of each frame.

The samples of analog channels follow the points of each frame and are skipped. The declared number
of frames is compared with the size of the file before any frame is read. Source: "The C3D file
format user guide" (Motion Lab Systems 2008), chapters 3 and 6.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.errors import FormatNotSupported
from app.formats.c3d.frame_count import declared_counts, frame_count
from app.formats.c3d.header import Header, read_header, with_true_analog
from app.formats.c3d.parameters import BLOCK, Numbers, Parameters, read_parameters
from app.formats.common.failures import too_large, unreadable_byte
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.common.world_positions import MAX_JOINT_FRAMES
from app.kinedex_error import KinedexError, Place
from app.motion.skeleton.recording import FRAME_RATES, Caution
from app.numerics.arrays import FloatArray


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


def read_points(content: bytes) -> Points:
    """Read the points of a C3D file.

    Raises Unreadable with the byte, FormatNotSupported for rotations alone, and TooLarge.
    """
    if len(content) < BLOCK:
        raise unreadable_byte(len(content), f"expected a header of {BLOCK} bytes, found the end")
    numbers, parameters = read_parameters(content)
    declared = read_header(content, numbers)
    if not declared.points:
        raise _without_points(parameters)
    header, cautions = with_true_analog(declared, parameters, len(content))
    start, frame_bytes = header.start, header.frame_bytes
    # The number of whole frames for which the file has bytes.
    room = max(0, len(content) - start) // frame_bytes if start > 0 else 0
    counts = declared_counts(header.first, header.last, parameters)
    frames, more = frame_count(counts, room, start, frame_bytes)
    if frames * header.points > MAX_JOINT_FRAMES:
        raise too_large("frames", f"expected at most {MAX_JOINT_FRAMES} points times frames")
    # (frames, bytes of a frame) -> the bytes of the points alone, without analog samples
    raw = np.frombuffer(content, "u1", frames * frame_bytes, start).reshape(frames, frame_bytes)
    width = 2 if header.scale > 0 else 4
    points = raw[:, : 4 * width * header.points].tobytes()
    positions, doubts = _positions(points, header, numbers, frames)
    return Points(
        labels=_labels(parameters, header.points),
        positions=positions,
        first_frame=header.first,
        frame_rate=_rate(header, parameters),
        parameters=parameters,
        cautions=cautions + more + doubts,
    )


def _without_points(parameters: Parameters) -> KinedexError:
    """The error for a file without points; Theia3D writes files of rotations alone."""
    if "ROTATION:USED" not in parameters and "ROTATION:LABELS" not in parameters:
        return unreadable_byte(2, "expected points, found none")
    return FormatNotSupported(
        "This C3D file has rotations of segments and no points (Theia3D writes such files). Export"
        " joint centers or landmarks as points too.",
        places=[Place("byte 2", "expected points, found none, but a group ROTATION")],
    )


def _positions(
    raw: bytes, header: Header, numbers: Numbers, frames: int
) -> tuple[FloatArray, tuple[Caution, ...]]:
    """(frames, points, 3) float32 in the unit and axes of the file, NaN where not seen.

    raw: four numbers for each point of each frame: x, y, z and a residual. If every residual is
    negative, it says nothing and is ignored, with a caution.
    """
    shape = (frames, header.points, 4)
    if header.scale > 0:
        values = numbers.integers(raw).reshape(shape)
        positions = (values[..., :3] * header.scale).astype(np.float32)
    else:
        values = numbers.floats(raw).reshape(shape)
        positions = values[..., :3].copy()
    # A point was not seen if it has NaN, three zeros, or a negative residual.
    x, y, z = np.moveaxis(positions, -1, 0)
    with np.errstate(invalid="ignore"):
        largest = np.maximum(np.maximum(np.abs(x), np.abs(y)), np.abs(z))
        seen = (largest <= MAX_MAGNITUDE) & (largest > 0)
        by_residual = seen & (values[..., 3] >= 0)
    cautions: tuple[Caution, ...] = ()
    if seen.any() and not by_residual.any():
        detail = "every residual is negative, as if no point was ever seen; residuals are ignored"
        cautions = (Caution("residuals_ignored", detail),)
    else:
        seen = by_residual
    positions[~seen] = np.nan
    return positions, cautions


def _labels(parameters: Parameters, points: int) -> tuple[str, ...]:
    """(points,) the labels. The parameter LABELS has at most 255; LABELS2 and others follow."""
    labels: list[str] = []
    for number in range(1, points // 255 + 2):
        more = parameters.get(f"POINT:LABELS{number if number > 1 else ''}")
        labels += more.texts if more is not None else ()
    return tuple(labels[:points]) + ("",) * (points - len(labels))


def _rate(header: Header, parameters: Parameters) -> float | None:
    parameter = parameters.get("POINT:RATE")
    for rate in (parameter.first if parameter is not None else None, header.rate):
        if rate is not None and FRAME_RATES[0] <= rate <= FRAME_RATES[1]:
            return float(np.float32(rate))
    return None
