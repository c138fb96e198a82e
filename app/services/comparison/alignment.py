"""Two ready clips, or parts of them, along the path that warps one onto the other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace

import numpy as np

from app.analysis.descriptors.alignment import align, peaks
from app.analysis.descriptors.frame_features import WARPING_RATE
from app.kinedex_error import KinedexError, Place
from app.motion.frame.body_frame import body_length
from app.numerics.arrays import FloatArray, IntArray
from app.search.example.distances import ACTIVE, FEATURES, active_frames, first_active_frame
from app.services import fields
from app.services.find.query import QueryDescriptors, describe, query_motion
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.store.clips.record import ClipRecord

MAX_SECONDS = 300.0
"""The longest part of a clip that is aligned. The table of a pair grows with both lengths: two
parts of this length need 0.15 GB and a second."""

MAX_PEAKS = 5
"""The number of moments of greatest difference that are named."""

OTHER_FIELDS = {"clip_id": "other", "start": "other_start", "end": "other_end"}
"""The fields of the second clip, by the names that they have for the first."""

COMPARED = (FEATURES, ACTIVE)
"""The arrays of a motion that an alignment needs."""

_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class Part:
    """A stored clip, or its part from `start` to `end` seconds; None is its own start or end."""

    clip_id: str
    start: float | None = None
    end: float | None = None


@dataclass(frozen=True, slots=True)
class AlignedClips:
    """Two clips along their warping path of k steps.

    distance: as of a search by the method `dtw`. body_lengths: meters, of both bodies; both are
    scaled to their mean. times: (k, 2) seconds from the start of each clip. differences: (k, 13)
    meters, of the joints in SUN_ROLES order. peaks: (p,) the steps of greatest mean difference.
    """

    distance: float
    body_lengths: tuple[float, float]
    times: FloatArray
    differences: FloatArray
    peaks: IntArray


@dataclass(frozen=True, slots=True)
class Side:
    """One of two motions: features (m, 82), its first time in seconds, its size in meters.

    seconds: between two of its frames.
    """

    features: FloatArray
    start: float
    body_length: float
    seconds: float = 1.0 / WARPING_RATE

    def thinned(self, most: int) -> Side:
        """At most `most` frames, evenly spaced."""
        stride = math.ceil(len(self.features) / most)
        return replace(self, features=self.features[::stride], seconds=self.seconds * stride)


def align_clips(lib: Library, one: Part, other: Part) -> AlignedClips:
    """The alignment of two clips or parts; both may be parts of the same clip.

    Raises BadField for a part that is outside of its clip or longer than MAX_SECONDS,
    ClipNotFound and ClipNotReady, which name the fields of the second clip as OTHER_FIELDS does.
    """
    ours = _side(lib, one)
    with _renamed(OTHER_FIELDS):
        theirs = _side(lib, other)
    return align_sides(ours, theirs)


def align_sides(ours: Side, theirs: Side) -> AlignedClips:
    """The alignment of two motions."""
    found = align(ours.features, theirs.features)
    paces = np.multiply((ours.seconds, theirs.seconds), WARPING_RATE)
    found = replace(found, times=found.times * paces)
    sizes = (ours.body_length, theirs.body_length)
    return AlignedClips(
        distance=found.distance,
        body_lengths=sizes,
        times=np.add(found.times, (ours.start, theirs.start)),
        differences=found.differences * np.mean(sizes),
        peaks=peaks(found, MAX_PEAKS),
    )


def _side(lib: Library, part: Part) -> Side:
    _check_length(ready_clip(lib, part.clip_id), part)
    source = QuerySource(part.clip_id, start=part.start, end=part.end)
    return side_of(lib, describe(lib, source, COMPARED))


def side_of(lib: Library, described: QueryDescriptors) -> Side:
    """One side of an alignment. described: with the arrays COMPARED."""
    arrays, motion = described.arrays, query_motion(lib, described)
    # Search compares active parts too, so both have the same distance.
    features, span = active_frames(arrays[FEATURES], arrays[ACTIVE]), arrays[ACTIVE]
    first = math.floor((described.source.start or 0.0) * motion.frame_rate + _ROUNDING)
    idle = first_active_frame(span) / WARPING_RATE
    return Side(np.asarray(features), first / motion.frame_rate + idle, body_length(motion))


def _check_length(clip: ClipRecord, part: Part) -> None:
    duration = clip.duration or 0.0
    seconds = min(part.end or duration, duration) - (part.start or 0.0)
    if seconds > MAX_SECONDS:
        field = "clip_id" if part.end is None else "end"
        message = f"the part is {seconds:.0f} s long; at most {MAX_SECONDS:.0f} s can be aligned"
        raise fields.bad_field(field, f"{message}: choose a shorter part by start and end")


@contextmanager
def _renamed(names: Mapping[str, str]) -> Iterator[None]:
    """Failures name the fields of the second clip."""
    try:
        yield
    except KinedexError as failure:
        places = [
            Place(names.get(place.location, place.location), place.message)
            for place in failure.places
        ]
        field, colon, rest = failure.detail.partition(": ")
        detail = names.get(field, field) + colon + rest
        raise type(failure)(detail, places=places) from failure
