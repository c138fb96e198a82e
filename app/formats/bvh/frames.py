"""Reads the MOTION part of a BVH file: the frame time and the numbers of each frame.

No memory is allocated by the declared number of frames, because it may be wrong. All lines are
read, and their number is compared with the declared one at the end.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain, islice

import numpy as np

from app.formats.common.decimals import plain_table
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.lines import filled_lines
from app.formats.common.numbers import check_magnitudes, excerpt, parse_any_numbers
from app.motion.skeleton.recording import FRAME_RATES, Caution
from app.numerics.arrays import FloatArray

MAX_FRAMES = 1_000_000
"""The most frames of a clip: more than two hours at 120 Hz."""
MAX_HEADER_LINE = 200
"""Bytes of the longest header line. The time of patterns grows faster than the line."""
MIN_RATE, MAX_RATE = FRAME_RATES
"""Hz: the smallest and the largest frame rate. A declared rate outside is ignored."""
NEAR_WHOLE = 1e-4
"""The relative distance from a whole number up to which a rate is rounded to it, because programs
round the frame time when they write it."""
BLOCK_LINES = 1024
"""Lines that are read at once."""

_FRAMES = re.compile(rb"\s*frames\s*:?\s*(\S*)\s*", re.IGNORECASE)
_FRAME_TIME = re.compile(rb"\s*frame\s*time\s*:?\s*(\S*)\s*", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Frames:
    """numbers: (frames, channels) float64 as in the file; frame_rate: Hz or None."""

    numbers: FloatArray
    frame_rate: float | None
    cautions: tuple[Caution, ...]


def read_frames(text: bytes, first_line: int, channels: int) -> Frames:
    """Read the lines after the line MOTION.

    text: lines separated by newlines. first_line: the line of the file on which `text` starts.
    channels: the numbers of a frame. Raises Unreadable with the line, and TooLarge for more than
    MAX_FRAMES.
    """
    lines = filled_lines(text, first_line)
    declared = _declared_frames(*next(lines, (first_line, b"")))
    line, time = next(lines, (first_line, b""))
    rate, cautions = _frame_rate(line, time)
    numbers = _rows(lines, channels)
    if not len(numbers):
        raise unreadable_line(line + 1, f"expected frames of {channels} numbers, found none")
    if declared != len(numbers):
        detail = f"the file declares {declared} frames but has {len(numbers)}"
        cautions += (Caution("frames_mismatch", detail),)
    return Frames(numbers, rate, cautions)


def _declared_frames(line: int, text: bytes) -> int:
    match = _header(_FRAMES, text)
    if match is None or not re.fullmatch(rb"\d{1,18}", match.group(1)):
        raise unreadable_line(line, f"expected 'Frames:' and a number, found {excerpt(text)}")
    return int(match.group(1))


def _frame_rate(line: int, text: bytes) -> tuple[float | None, tuple[Caution, ...]]:
    match = _header(_FRAME_TIME, text)
    if match is None:
        raise unreadable_line(line, f"expected 'Frame Time:' and seconds, found {excerpt(text)}")
    try:
        period = float(match.group(1).replace(b",", b"."))
    except ValueError:
        period = 0.0
    if not 1 / MAX_RATE <= period <= 1 / MIN_RATE:
        detail = f"line {line}: expected a frame time in seconds, found {excerpt(match.group(1))}"
        return None, (Caution("frame_time_unusable", detail),)
    return _rounded_if_near(1 / period), ()


def _header(pattern: re.Pattern[bytes], text: bytes) -> re.Match[bytes] | None:
    return pattern.fullmatch(text) if len(text) <= MAX_HEADER_LINE else None


def _rounded_if_near(rate: float) -> float:
    whole = float(round(rate))
    return whole if abs(rate - whole) <= NEAR_WHOLE * rate else rate


def _rows(lines: Iterator[tuple[int, bytes]], channels: int) -> FloatArray:
    """(frames, channels) the numbers, read in blocks of lines."""
    blocks: list[FloatArray] = []
    while len(block := _block(lines, channels)):
        blocks.append(block)
        if len(blocks) * BLOCK_LINES > MAX_FRAMES:
            raise too_large("frames", f"expected at most {MAX_FRAMES}")
    return np.concatenate(blocks) if blocks else np.zeros((0, channels))


def _block(lines: Iterator[tuple[int, bytes]], channels: int) -> FloatArray:
    """(n, channels) up to BLOCK_LINES frames. Each starts on a new line and may have several."""
    taken = list(islice(lines, BLOCK_LINES))
    plain = plain_table([text for _, text in taken], channels)
    if plain is None:
        return _block_by_line(taken, lines, channels)
    check_magnitudes(plain, [line for line, _ in taken])
    return plain


def _block_by_line(
    taken: list[tuple[int, bytes]], lines: Iterator[tuple[int, bytes]], channels: int
) -> FloatArray:
    """(n, channels) the frames of `taken`, line by line; the last one may continue in `lines`."""
    rest = chain(taken, lines)
    rows: list[FloatArray] = []
    numbers: list[int] = []
    for line, text in islice(rest, BLOCK_LINES):
        row = parse_any_numbers(text, line, expected=channels)
        if len(row) < channels:
            row = _continued(row, rest, line, channels)
        if len(row) != channels:
            raise unreadable_line(line, f"expected {channels} numbers, found {len(row)}")
        rows.append(row)
        numbers.append(line)
    block = np.stack(rows) if rows else np.zeros((0, channels))
    check_magnitudes(block, numbers)
    return block


def _continued(
    row: FloatArray, lines: Iterator[tuple[int, bytes]], line: int, channels: int
) -> FloatArray:
    """`row` with the numbers of the next lines if these complete it exactly, else `row` alone."""
    parts, found = [row], len(row)
    while found < channels:
        number, text = next(lines, (line, b""))
        parts.append(parse_any_numbers(text, number))
        if not len(parts[-1]):
            break
        found += len(parts[-1])
    return np.concatenate(parts) if found == channels else row
