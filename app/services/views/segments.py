"""A ready clip's segments, from keypose to keypose, and the cycles that they form."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.analysis.segments.segments import (
    SEGMENT_CYCLES,
    SEGMENT_SPANS,
    SEGMENT_VECTORS,
    describe_segments,
)
from app.errors import NotFound
from app.motion.frame.body_frame import ANALYSIS_RATE, body_track
from app.search.example.distances import FEATURES
from app.services.library.keypose_frames import keypose_frames
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.library.stored_motion import load_motion
from app.store.clips import arrays
from app.store.clips.record import ClipRecord

_NAMES = (SEGMENT_SPANS, SEGMENT_VECTORS, SEGMENT_CYCLES)


@dataclass(frozen=True, slots=True)
class Segment:
    """The motion from one keypose to the next: its number from 0, start and end in seconds, and
    the number of its cycle, if it has one."""

    index: int
    start: float
    end: float
    cycle: int | None

    @property
    def duration(self) -> float:
        """Seconds."""
        return round(self.end - self.start, 6)


@dataclass(frozen=True, slots=True)
class SegmentCycle:
    """One repetition of a repeated sequence: segments first..first+count-1, from start to end in
    seconds. The cycles of one run are repetitions of each other."""

    index: int
    run: int
    first: int
    count: int
    start: float
    end: float

    @property
    def duration(self) -> float:
        """Seconds."""
        return round(self.end - self.start, 6)


@dataclass(frozen=True, slots=True)
class Segments:
    """The segments of a clip and their cycles, both sorted by time."""

    segments: tuple[Segment, ...]
    cycles: tuple[SegmentCycle, ...]


def list_segments(lib: Library, clip_id: str) -> Segments:
    """A clip's segments and cycles. Raises ClipNotFound, ClipNotReady."""
    found = segment_arrays(lib, ready_clip(lib, clip_id))
    spans = np.round(found[SEGMENT_SPANS].astype(float), 6).tolist()
    cycles = tuple(
        SegmentCycle(number, run, first, stop - first, spans[first][0], spans[stop - 1][1])
        for number, (first, stop, run) in enumerate(found[SEGMENT_CYCLES].tolist())
    )
    cycle_of = {c.first + step: c.index for c in cycles for step in range(c.count)}
    segments = tuple(
        Segment(index, start, end, cycle_of.get(index)) for index, (start, end) in enumerate(spans)
    )
    return Segments(segments, cycles)


def segment_arrays(lib: Library, clip: ClipRecord) -> dict[str, NDArray[Any]]:
    """The stored arrays of a ready clip's segments, by name (see `describe_segments`).

    They are computed here for a clip whose analysis is older than their storage.
    """
    try:
        with lib.store.read() as tx:
            return {name: arrays.get_one(tx, clip.id, name) for name in _NAMES}
    except NotFound:
        frames = keypose_frames(lib, clip.id, body_track(load_motion(lib, clip)))
    with lib.store.read() as tx:
        features = arrays.get_one(tx, clip.id, FEATURES)
    return describe_segments(features, frames / ANALYSIS_RATE)
