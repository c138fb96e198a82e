"""The number of frames of a C3D file.

The header has only 16 bits for it, so the parameters are used too, and the size of the file.
"""

from __future__ import annotations

import numpy as np

from app.formats.c3d.parameters import BLOCK, Parameters
from app.formats.common.failures import unreadable_byte
from app.motion.skeleton.recording import Caution

MAX_HEADER_FRAME = 65535
"""The last frame in the header if its true number does not fit in 16 bits."""
MIN_WHOLE_SHARE = 0.9
"""The least share of the declared frames that a file must have. Below, it is cut short."""
MAX_UNREAD_SHARE = 0.05
"""The share of the data that may be left unread without a caution, and MAX_UNREAD_BLOCKS."""
MAX_UNREAD_BLOCKS = 2
_WRAP = 2**16


def frame_count(
    declared: list[int], room: int, start: int, frame_bytes: int
) -> tuple[int, tuple[Caution, ...]]:
    """The number of frames to read, and cautions.

    declared: by the header and the parameters. room: the number of frames for which the file has
    bytes, from the byte `start` on. Raises Unreadable if the file is cut short.
    """
    possible = [count for count in declared if count <= room]
    if not possible:
        return _cut_short(min(declared) if declared else 1, room, start)
    frames, most = max(possible), max(declared)
    if frames < most:
        detail = f"the file declares {most} frames but has {frames}"
        return frames, (Caution("frames_mismatch", detail),)
    whole = _unwrapped(frames, room, frame_bytes)
    if whole > frames:
        detail = f"the file declares {frames} frames, but its data has {whole}, which are read: the"
        detail += f" declared number cannot be larger than {MAX_HEADER_FRAME}"
        return whole, (Caution("frames_mismatch", detail),)
    unread = (room - frames) * frame_bytes
    if unread > max(MAX_UNREAD_BLOCKS * BLOCK, MAX_UNREAD_SHARE * room * frame_bytes):
        detail = f"the file declares {frames} frames and has data for {room}; the rest is not read"
        return frames, (Caution("data_unread", detail),)
    return frames, ()


def _cut_short(expected: int, room: int, start: int) -> tuple[int, tuple[Caution, ...]]:
    if room < MIN_WHOLE_SHARE * expected or not room:
        message = f"expected {expected} frames, found {room}: the file is cut short"
        raise unreadable_byte(start, message)
    detail = f"the file declares {expected} frames but has {room}: its end is missing"
    return room, (Caution("frames_mismatch", detail),)


def _unwrapped(frames: int, room: int, frame_bytes: int) -> int:
    """The number of frames if 16 bits were too few for it, else `frames`.

    The data may end with an incomplete block.
    """
    padding = BLOCK // frame_bytes + 1
    if frames >= MAX_HEADER_FRAME - 1 and room > frames + padding:
        return room
    missing = (room - frames) // _WRAP
    whole = frames + missing * _WRAP
    return whole if missing > 0 and room - whole <= padding else frames


def declared_counts(first: int, last: int, parameters: Parameters) -> list[int]:
    """The numbers of frames that the header and the parameters declare; empty if none does.

    first, last: the numbers of frames in the header.
    """
    candidates = (
        _count_of_header(first, last),
        _count_of_points(parameters),
        _count_of_trial(parameters),
        _long_count(parameters),
    )
    counts = [count for count in candidates if count is not None and 0 < count != MAX_HEADER_FRAME]
    if not counts and last == MAX_HEADER_FRAME:
        return [MAX_HEADER_FRAME - first + 1]
    return counts


def _count_of_header(first: int, last: int) -> int | None:
    if last < first or last == MAX_HEADER_FRAME:
        return None
    return last - first + 1


def _count_of_points(parameters: Parameters) -> int | None:
    declared = parameters.get("POINT:FRAMES")
    if declared is None or declared.first is None or not np.isfinite(declared.first):
        return None
    count = int(declared.first)
    # Counts above 32,767 are read as negative, because 16-bit integers have a sign.
    return count % _WRAP if count < 0 else count


def _long_count(parameters: Parameters) -> int | None:
    declared = parameters.get("POINT:LONG_FRAMES")
    if declared is None or declared.first is None or not 0 < declared.first < 2**31:
        return None
    # One float, or two 16-bit numbers.
    is_joined = len(declared.values) > 1 and np.isfinite(declared.values[1])
    return _joined(declared.values) if is_joined else int(declared.first)


def _count_of_trial(parameters: Parameters) -> int | None:
    start, end = (parameters.get(f"TRIAL:ACTUAL_{name}_FIELD") for name in ("START", "END"))
    if start is None or end is None or min(len(start.values), len(end.values)) < 2:
        return None
    if not np.isfinite([*start.values[:2], *end.values[:2]]).all():
        return None
    return _joined(end.values) - _joined(start.values) + 1


def _joined(halves: tuple[float, ...]) -> int:
    """The 32-bit number that is stored as two 16-bit numbers, the low one first."""
    return int(halves[0]) % _WRAP + _WRAP * (int(halves[1]) % _WRAP)
