"""Parts of a query that are no examples and no words: a sequence of poses, and a rhythm."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from app.kinedex_error import KinedexError, Place
from app.numerics.arrays import FloatArray, IntArray
from app.search.composed.by_parts import Evidence
from app.search.composed.pose_sequence import pose_evidence, same_clips
from app.search.composed.rhythm import rhythm_probabilities
from app.search.composed.surprise import Part
from app.search.index.rows import RowsView
from app.services.fields import bad_field
from app.services.find.by_pose import queried_pose
from app.services.find.queries import PoseQuery, PoseSequence, Rhythm
from app.services.library.library import Library

POSES, RHYTHM = "poses", "rhythm"
"""The names of these parts in a query."""
MAX_POSES = 5
MAX_WEIGHT = 100.0
MAX_RATE = 600.0
"""Cycles per minute."""
MAX_TOLERANCE = 1.0


@dataclass(frozen=True, slots=True)
class Criterion:
    """A part of a query that is ready to judge clips.

    name: its place in the query. key: identifies it for cursors. evidence: what it says about the
    clips `numbers` (k,) of the library's index. excluded: ids of the clips that it comes from.
    """

    name: str
    part: Part
    key: str
    evidence: Callable[[RowsView, IntArray], Evidence]
    excluded: frozenset[str] = frozenset()


def criteria_of(
    lib: Library,
    poses: PoseSequence | None,
    rhythm: Rhythm | None,
    *,
    include_self: bool = False,
) -> list[Criterion]:
    """The criteria of a query. Raises BadField, and what a search by pose raises."""
    found: list[Criterion] = []
    if poses is not None:
        found.append(_in_order(lib, poses, include_self=include_self))
    if rhythm is not None:
        found.append(_in_rhythm(rhythm))
    return found


def pose_vectors(lib: Library, poses: Sequence[PoseQuery]) -> tuple[FloatArray, frozenset[str]]:
    """(p, 36) the poses of a sequence, and the clips they come from."""
    if not 1 <= len(poses) <= MAX_POSES:
        raise bad_field(POSES, f"must be 1 to {MAX_POSES} poses")
    found = [_pose(lib, one, place) for place, one in enumerate(poses)]
    return np.stack([pose for pose, _ in found]), frozenset().union(*(ids for _, ids in found))


def _pose(lib: Library, query: PoseQuery, place: int) -> tuple[FloatArray, frozenset[str]]:
    try:
        return queried_pose(lib, query)
    except KinedexError as failure:
        where = f"{POSES}.sequence.{place}"
        places = [Place(f"{where}.{one.location}", one.message) for one in failure.places]
        raise type(failure)(failure.detail, places=places) from failure


def _in_order(lib: Library, asked: PoseSequence, *, include_self: bool) -> Criterion:
    own = [replace(one, include_self=include_self) for one in asked.poses]
    poses, excluded = pose_vectors(lib, own)
    part = Part(checked_weight(POSES, asked.weight), asked.is_against)

    def evidence(rows: RowsView, numbers: IntArray) -> Evidence:
        lib.poses.catch_up(lib.store)
        view = lib.poses.state[1]
        places = same_clips(rows.labels, rows.labels.ids[numbers], numbers, view.labels)
        return pose_evidence(part, poses, view, places, partial(lib.arrays.get_many, lib.store))

    return Criterion(POSES, part, f"{part} {poses.tobytes().hex()}", evidence, excluded)


def _in_rhythm(asked: Rhythm) -> Criterion:
    if not 0.0 < asked.rate <= MAX_RATE:
        message = f"must be above 0 and at most {MAX_RATE:g}"
        raise bad_field("rhythm.cycles_per_minute", message)
    if not 0.0 < asked.tolerance <= MAX_TOLERANCE:
        raise bad_field("rhythm.tolerance", f"must be above 0 and at most {MAX_TOLERANCE:g}")
    part = Part(checked_weight(RHYTHM, asked.weight), asked.is_against)

    def evidence(rows: RowsView, numbers: IntArray) -> Evidence:
        times = rows.labels.measured("cycle_time")[numbers]
        cyclicity = rows.labels.measured("cyclicity")[numbers]
        likely = rhythm_probabilities(times, cyclicity, asked.rate, asked.tolerance)
        return Evidence(part, likely)

    return Criterion(RHYTHM, part, f"{part} {asked.rate} {asked.tolerance}", evidence)


def checked_weight(part: str, weight: float) -> float:
    """The weight of a part of a query. Raises BadField."""
    if not (math.isfinite(weight) and 0.0 < weight <= MAX_WEIGHT):
        raise bad_field(f"{part}.weight", f"must be above 0 and at most {MAX_WEIGHT:g}")
    return weight
