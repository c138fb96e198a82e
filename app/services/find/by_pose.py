"""Find a pose (DESIGN 7, 8): which clips take it, and when."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from app.motion.frame.body_frame import ANALYSIS_RATE
from app.numerics.arrays import FloatArray
from app.search.index.filters import as_filter
from app.search.pose.by_pose import POSITIONS, PoseHit, PoseRanking
from app.search.pose.pose_places import Places
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import score
from app.services import fields
from app.services.find.find import DEFAULT_LIMIT, Filter
from app.services.find.hits import Hit, Hits
from app.services.find.pose_query import pose_at, pose_of
from app.services.find.query import Question, describe
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.files.files import Readable

METHOD = "pose"
SCALE = 0.25
"""Body lengths at which the score is one half: about that of a pose to clips that never take it."""


@dataclass(frozen=True, slots=True)
class PoseQuery:
    """A search by pose: of a stored clip or a file, at `time` seconds; or 13 `positions`.

    positions: (13, 3) metres in SUN_ROLES order, heading and size do not matter; places: how
    many of a clip may be hits; skeleton, frame_rate (Hz), unit, roles, stack: of a file.
    """

    clip_id: str | None = None
    content: Readable | None = None
    time: float | None = None
    positions: Sequence[Sequence[Any]] | None = None
    places: Places | str = Places.BEST
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    include_self: bool = False
    cursor: str | None = None
    skeleton: Readable | None = None
    frame_rate: float | str | None = None
    unit: float | str | None = None
    roles: Mapping[str, str] | None = None
    stack: str | None = None


def find_pose(lib: Library, query: PoseQuery) -> Hits:
    """Clips in order of how near they come to a pose, with the time at which they do.

    The query clip is left out unless `include_self`. Raises BadField, ClipNotFound,
    ClipNotReady, and BadContent for a file that cannot be used.
    """
    began = time.perf_counter()
    wanted, places, limit = (
        as_filter(query.filter),
        _places(query.places),
        fields.limit(query.limit),
    )
    version = lib.poses.catch_up(lib.store)
    pose = _pose(lib, query)
    exclude = frozenset({query.clip_id} if query.clip_id and not query.include_self else ())
    question = cursors.digest("pose", pose.tobytes().hex(), places, wanted, sorted(exclude))
    after = None if query.cursor is None else cursors.decode(query.cursor, question)
    _, rows = lib.poses.state
    load = partial(lib.arrays.get_many, lib.store)
    found = PoseRanking(rows, rows.labels.mask(wanted, exclude), pose, load, places)
    page = found.page(after, limit)
    rank = after.rank if after else 0
    following = None
    if page.more:
        distance, key = page.hits[-1].key
        following = cursors.encode(Position(rank + len(page.hits), distance, key), question)
    hits = _hits(lib, page.hits, rank)
    return Hits(METHOD, (time.perf_counter() - began) * 1000.0, version, hits, following)


def _pose(lib: Library, query: PoseQuery) -> FloatArray:
    """(36,) vector of the pose that is asked for."""
    if query.positions is not None:
        for name in ("clip_id", "content", "time"):
            if getattr(query, name) is not None:
                raise fields.bad_field(name, "does not go with positions")
        return pose_of(query.positions)
    if query.clip_id is None and query.content is None:
        raise fields.bad_field("positions", "give a clip_id and a time, or 13 positions")
    if query.time is None:
        raise fields.bad_field("time", "must be given: the seconds at which the pose is taken")
    asked = describe(lib, _question(query), (POSITIONS,))
    positions = asked.arrays[POSITIONS]
    duration = asked.clip.duration if asked.clip is not None else None
    return pose_at(positions, query.time, duration or len(positions) / ANALYSIS_RATE)


def _question(query: PoseQuery) -> Question:
    return Question(
        clip_id=query.clip_id,
        content=query.content,
        skeleton=query.skeleton,
        frame_rate=query.frame_rate,
        unit=query.unit,
        roles=query.roles,
        stack=query.stack,
    )


def _hits(lib: Library, found: Sequence[PoseHit], rank: int) -> tuple[Hit, ...]:
    """The places with their clips as they are now; those deleted meanwhile are left out."""
    with lib.store.read() as tx:
        clips = stored.get_many(tx, {hit.clip_id for hit in found})
    return tuple(
        Hit(
            rank=number,
            score=score(hit.place.distance, SCALE),
            distance=hit.place.distance,
            start=hit.place.start,
            end=min(hit.place.end, clip.duration or hit.place.end),
            clip=clip,
            time=hit.place.time,
        )
        for number, hit in enumerate(found, rank + 1)
        if (clip := clips.get(hit.clip_id)) is not None
    )


def _places(value: Places | str) -> Places:
    try:
        return Places(value)
    except ValueError as problem:
        known = ", ".join(Places)
        raise fields.bad_field("places", f"must be one of {known}") from problem
