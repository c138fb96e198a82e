"""The frames of an AMC file in the order of their own numbers, without gaps."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from app.formats.acclaim.amc_frames import AmcFrames
from app.formats.common.failures import unreadable_line
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import BoolArray, FloatArray, IntArray

USUAL_RATE = 120.0
"""Hz: the rate of CMU's and of most AMC files. The format does not require a file to give it."""
MAX_MISSING_SHARE = 0.5
"""The most missing frames, as a share of the frames in the file. If more are missing, the numbers
are wrong, and not the frames."""


@dataclass(frozen=True, slots=True)
class OrderedFrames:
    """Frames by rising number. numbers: (frames, channels). step: between two frame numbers."""

    numbers: FloatArray
    step: int
    cautions: tuple[Caution, ...]


def in_number_order(frames: AmcFrames) -> OrderedFrames:
    """Sort frames by number and fill gaps by the frame before, each with a caution.

    If the numbers rise evenly by more than one, the motion has a lower rate. Raises Unreadable,
    with the line, for a number that occurs twice and for a gap that is too wide.
    """
    cautions: list[Caution] = []
    order = np.argsort(frames.numbering, kind="stable")
    numbering, lines = frames.numbering[order], frames.lines[order]
    moved = np.flatnonzero(order != np.arange(len(order)))
    if len(moved):
        first = int(lines[moved[0]])
        detail = f"line {first}: frames do not come in the order of their numbers; sorted"
        place = (int(moved[0]), int(moved[-1]) + 1)
        cautions.append(Caution("frames_out_of_order", detail, frames=place))
    steps = np.diff(numbering)
    if (steps == 0).any():
        line = int(lines[1:][steps == 0][0])
        raise unreadable_line(
            line, f"expected each frame once, found {_number_after(numbering, steps == 0)} twice"
        )
    step = int(steps.min()) if len(steps) else 1
    # Frames 0, 4, 8 are all frames at a lower rate. Frames 0, 4, 6 have gaps.
    if (steps % step).any():
        step = 1
    missing = int((steps // step - 1).sum())
    if missing > MAX_MISSING_SHARE * len(numbering):
        wide = steps == steps.max()
        raise unreadable_line(
            int(lines[1:][wide][0]),
            f"expected frames without gaps, found {_number_after(numbering, wide)}",
        )
    repeats = np.append(steps // step, 1).astype(np.int64)
    if missing:
        detail = f"{missing} frames are missing; each repeats the frame before it"
        cautions.append(Caution("frames_missing", detail, frames=_longest_repeat(repeats)))
    return OrderedFrames(np.repeat(frames.numbers[order], repeats, axis=0), step, tuple(cautions))


def _longest_repeat(repeats: IntArray) -> tuple[int, int]:
    """The frames that repeat the same one most often: the first, and the one after the last.

    repeats: (frames,) how often each frame of the file occurs.
    """
    longest = int(np.argmax(repeats))
    end = int(repeats[: longest + 1].sum())
    return end - int(repeats[longest]) + 1, end


def _number_after(numbering: IntArray, chosen: BoolArray) -> int:
    """The first frame number after a chosen step; chosen: (frames - 1,) steps."""
    return int(numbering[1:][chosen][0])
