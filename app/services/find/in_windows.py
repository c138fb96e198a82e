"""Find a motion inside clips (DESIGN 7, 8): which part of which clip is like it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from functools import partial

from app.analysis.descriptors.windows import WindowScale
from app.motion.frame.body_frame import ANALYSIS_RATE
from app.search.example.distances import FEATURES
from app.search.example.methods import Method
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Anchor, Position
from app.search.ranking.ranking import score
from app.search.windows.in_windows import WINDOW_SCORES, by_both, by_warping, by_windows
from app.search.windows.overlap_merging import Candidates, FoundInterval, merge_overlapping
from app.search.windows.parts import Parts
from app.search.windows.proposals import ExcludedInterval, QuerySegment
from app.services import fields
from app.services.find.hits import Hit, Hits
from app.services.find.query import Answered, Question, describe
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.clips.filter import ClipFilter

LONGEST_SECONDS = 120.0
"""Of a query in windows; what is longer is a clip of its own, and found as one."""


@dataclass(frozen=True, slots=True)
class Paging:
    """What of a ranking is wanted: its first `limit` hits, or so many behind a cursor.

    include_self: whether the query's own place may be among them.
    """

    limit: int
    cursor: str | None = None
    include_self: bool = False


def find_in_windows(
    lib: Library, question: Question, method: Method, wanted: ClipFilter, paging: Paging
) -> Hits:
    """Parts of clips in order of likeness to a motion; the index has caught up.

    Raises BadField, ClipNotFound, ClipNotReady, and BadContent for an upload that cannot be
    used.
    """
    if method not in WINDOW_SCORES:
        known = ", ".join(WINDOW_SCORES)
        raise fields.bad_field("method", f"with scope windows it must be one of {known}")
    asked = describe(lib, question, (FEATURES,))
    segment = _segment(asked, question)
    excluded = None if paging.include_self else own_place(asked, question)
    fingerprint = _fingerprint(asked, segment, method, wanted, excluded)
    after = None if paging.cursor is None else cursors.decode(paging.cursor, fingerprint)
    found, anchor = _rank(lib, method, wanted, segment, excluded, after)
    told, more = merge_overlapping(found, paging.limit, after)
    rank = after.rank if after else 0
    following = None
    if more:
        last = Position(rank + len(told), told[-1].distance, told[-1].key, anchor)
        following = cursors.encode(last, fingerprint)
    hits = place_hits(lib, told, rank, WINDOW_SCORES[method])
    return Hits(method.value, 0.0, lib.index.version, hits, following)


def _fingerprint(
    asked: Answered,
    segment: QuerySegment,
    method: Method,
    wanted: ClipFilter,
    excluded: ExcludedInterval | None,
) -> str:
    """What binds a cursor to its question; an upload is known by its features."""
    content = hashlib.sha256(segment.features.tobytes()).hexdigest()
    clip_id = asked.clip.id if asked.clip else None
    return cursors.digest("windows", clip_id, content, method, wanted, excluded)


def _rank(
    lib: Library,
    method: Method,
    wanted: ClipFilter,
    segment: QuerySegment,
    excluded: ExcludedInterval | None,
    after: Position | None,
) -> tuple[Candidates, Anchor | None]:
    load = partial(lib.arrays.get_many, lib.store)
    if method is Method.DTW:
        clips = lib.index.candidates(wanted)
        return by_warping(clips.ids, clips.seconds, segment, excluded, load), None
    view = partial(_view, lib, wanted)
    if method is Method.VECTOR:
        return by_windows(view, segment, excluded), None
    return by_both(view, segment, excluded, load, after.anchor if after else None)


def _view(lib: Library, wanted: ClipFilter, scale: WindowScale) -> Parts:
    index = lib.windows[scale.name]
    index.catch_up(lib.store)
    return Parts.of(index.state[1], wanted)


def _segment(asked: Answered, question: Question) -> QuerySegment:
    seconds = seconds_of(asked, question)
    if seconds > LONGEST_SECONDS:
        most = f"{LONGEST_SECONDS:g} s are the most that is looked for in windows"
        raise fields.bad_field("end", f"{most}; start and end leave {seconds:.1f} s")
    return QuerySegment(asked.arrays[FEATURES], seconds)


def seconds_of(asked: Answered, question: Question) -> float:
    """How long the query is: of an upload, as long as what was analysed of it."""
    start, end = question.start or 0.0, question.end
    if end is None and asked.clip is None:
        return len(asked.arrays["role_positions"]) / ANALYSIS_RATE
    if end is None and asked.clip is not None:
        end = asked.clip.duration or 0.0
    return (end or 0.0) - start


def own_place(asked: Answered, question: Question) -> ExcludedInterval | None:
    """The queried part of a stored clip."""
    if asked.clip is None:
        return None
    start = question.start or 0.0
    return ExcludedInterval(asked.clip.id, start, start + seconds_of(asked, question))


def place_hits(lib: Library, told: list[FoundInterval], rank: int, scale: float) -> tuple[Hit, ...]:
    """The places with their clips as they are now; those deleted meanwhile are left out."""
    with lib.store.read() as tx:
        clips = stored.get_many(tx, {place.clip_id: None for place in told})
    return tuple(
        Hit(
            rank=number,
            score=score(place.distance, scale),
            distance=place.distance,
            start=place.start,
            end=min(place.end, clip.duration or place.end),
            clip=clip,
        )
        for number, place in enumerate(told, rank + 1)
        if (clip := clips.get(place.clip_id)) is not None
    )
