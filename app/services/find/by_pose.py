"""Find a pose: the clips in which it occurs, and its times."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from typing import Any

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray
from app.search.pose.by_pose import POSITIONS, PoseHit, PoseRanking
from app.search.pose.pose_matches import MatchesPerClip
from app.search.ranking import cursor as cursors
from app.search.ranking.ranking import score
from app.services import fields
from app.services.find.hits import Hits, milliseconds_since
from app.services.find.paging import Match, MatchPage, Paging
from app.services.find.pose_query import pose_at, pose_of
from app.services.find.queries import PoseQuery
from app.services.find.query import describe
from app.services.library.filters import resolved_filter
from app.services.library.library import Library

METHOD = "pose"
SCALE = 0.25
"""Body lengths at which the score is one half: about the distance of a pose from clips in which
it does not occur."""


def find_pose(lib: Library, query: PoseQuery) -> Hits:
    """Clips ranked by the distance of their nearest pose to the queried pose.

    The query clip is left out unless `include_self`, also if the query is its file. Raises
    BadField, ClipNotFound, ClipNotReady, and BadContent for a file that cannot be used.
    """
    began = time.perf_counter()
    clip_filter, places = resolved_filter(lib, query.filter), _places(query.places)
    fields.limit(query.limit)
    version = lib.poses.catch_up(lib.store)
    pose, exclude = queried_pose(lib, query)
    question = cursors.digest("pose", pose.tobytes().hex(), places, clip_filter, sorted(exclude))
    paging = Paging.at(query.cursor, question, query.clip_fields)
    _, rows = lib.poses.state
    load = partial(lib.arrays.get_many, lib.store)
    ranking = PoseRanking(rows, rows.labels.mask(clip_filter, exclude), pose, load, places)
    found = ranking.page(paging.after, query.limit)
    matches = MatchPage([_match(hit) for hit in found.hits], found.more)
    page = paging.hits(lib, matches, partial(score, scale=SCALE))
    return Hits(METHOD, milliseconds_since(began), version, page.items, page.next)


def queried_pose(lib: Library, query: PoseQuery) -> tuple[FloatArray, frozenset[str]]:
    """(36,) vector of the queried pose, and the clips that must not be hits.

    Raises what `find_pose` raises.
    """
    if query.positions is not None:
        return _given_pose(query, query.positions), frozenset()
    if query.source is None:
        raise fields.bad_field("positions", "give a clip_id and a time, or 13 positions")
    if query.time is None:
        raise fields.bad_field("time", "must be given: the time of the pose, in seconds")
    described = describe(lib, query.source, (POSITIONS,))
    positions = described.arrays[POSITIONS]
    duration = described.clip.duration if described.clip is not None else None
    pose = pose_at(positions, query.time, duration or len(positions) / ANALYSIS_RATE)
    return pose, described.excluded_clips(include_self=query.include_self)


def _given_pose(query: PoseQuery, positions: Sequence[Sequence[Any]]) -> FloatArray:
    """(36,) vector of 13 positions. Raises BadField if the query also has a clip or a time."""
    if query.source is not None:
        name = "content" if query.source.clip_id is None else "clip_id"
        raise fields.bad_field(name, "cannot be used together with positions")
    if query.time is not None:
        raise fields.bad_field("time", "cannot be used together with positions")
    return pose_of(positions)


def _match(hit: PoseHit) -> Match:
    """A ranked pose of a clip as the match of a page."""
    distance, key = hit.key
    return Match(hit.clip_id, key, distance, hit.match.start, hit.match.end, hit.match.time)


def _places(value: MatchesPerClip | str) -> MatchesPerClip:
    try:
        return MatchesPerClip(value)
    except ValueError as problem:
        known = ", ".join(MatchesPerClip)
        raise fields.bad_field("places", f"must be one of {known}") from problem
