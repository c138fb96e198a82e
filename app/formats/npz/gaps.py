"""Fills the gaps (NaN) in arrays of positions, or finds the longest stretch without long gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import Unreadable
from app.kinedex_error import Place
from app.motion.skeleton.occlusion import (
    Gap,
    fill_gaps,
    hidden,
    longest_gap,
    runs,
    without_sentinels,
)
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import BoolArray, FloatArray

RATE_FOR_GAPS = 30.0
"""Hz: the rate that converts gaps to seconds if the file does not give its rate."""
MAX_GAPS_SHOWN = 8
"""The most gaps that an error names."""
MIN_SECONDS = 0.5
"""The shortest stretch that is read in place of the whole array."""


@dataclass(frozen=True, slots=True)
class Whole:
    """Positions without gaps.

    positions: (frames, joints, 3) float32. start: the frames of the array before the first one.
    """

    positions: FloatArray
    start: int = 0
    cautions: tuple[Caution, ...] = ()


def without_gaps(positions: FloatArray, names: Sequence[str] | None, rate: float | None) -> Whole:
    """The positions (frames, joints, 3) with short gaps filled, in the longest stretch without
    long gaps.

    names: (joints,) or None. rate: Hz, None if unknown. Raises Unreadable with the joints and the
    frames of long gaps if no stretch is long enough.
    """
    positions = without_sentinels(positions)
    if np.isfinite(positions).all():
        return Whole(positions)
    rate = rate or RATE_FOR_GAPS
    filled = fill_gaps(positions, rate)
    known: BoolArray = np.asarray(np.isfinite(filled.positions).all(axis=(1, 2)))
    start, end = max(runs(known), key=lambda run: run[1] - run[0], default=[0, 0])
    was_hidden = hidden(positions[start:end])
    cautions = _filled(was_hidden & ~hidden(filled.positions[start:end]), names, start)
    if end - start < len(known):
        if end - start < MIN_SECONDS * rate:
            raise _hidden_too_long(filled.long_gaps, names)
        detail = f"joints are hidden for long times, so only frames {start} to {end - 1} are read,"
        detail += f" which are {end - start} of {len(known)} frames"
        cautions += (Caution("frames_trimmed", detail),)
    return Whole(filled.positions[start:end].astype(np.float32), start, cautions)


def _filled(filled: BoolArray, names: Sequence[str] | None, start: int) -> tuple[Caution, ...]:
    """A caution with the longest gap that was filled.

    filled: (frames, joints) whether it was filled; start: the frames of the array before them.
    """
    gap = longest_gap(filled)
    if gap is None:
        return ()
    joint = names[gap.marker] if names else f"joint_{gap.marker}"
    detail = f"joints hidden for short times were filled in: {100 * filled.mean():.1f} % of their"
    detail += f" frames; longest {joint}, frames {start + gap.start} to {start + gap.end - 1}"
    return (Caution("gaps_filled", detail, frames=gap.frames, joint=joint),)


def _hidden_too_long(gaps: Sequence[Gap], names: Sequence[str] | None) -> Unreadable:
    places = [
        Place(
            f"frame {gap.start}, joint {gap.marker}" + (f" ({names[gap.marker]})" if names else ""),
            f"expected a position, found NaN in {gap.end - gap.start} frames",
        )
        for gap in gaps[:MAX_GAPS_SHOWN]
    ]
    shown = "; ".join(f"{place.location}: {place.message}" for place in places)
    return Unreadable(f"Joints are hidden for too long to be filled in: {shown}", places=places)
