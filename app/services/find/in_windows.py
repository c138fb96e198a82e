"""Find a motion inside clips: the parts of clips that are most similar to it."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from functools import partial

from app.analysis.descriptors.windows import WindowScale
from app.search.example.distances import FEATURES
from app.search.example.methods import Method
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Anchor
from app.search.ranking.ranking import score
from app.search.windows.in_windows import WINDOW_SCORES, by_both, by_warping, by_windows
from app.search.windows.overlap_merging import Candidates, FoundInterval, merge_overlapping
from app.search.windows.parts import Parts
from app.search.windows.proposals import ExcludedInterval, QuerySegment
from app.services import fields
from app.services.find.hits import HitPage
from app.services.find.paging import Match, MatchPage, Paging
from app.services.find.queries import MotionQuery
from app.services.find.query import QueryDescriptors, describe
from app.services.library.library import Library
from app.store.clips.filter import ClipFilter

MAX_SECONDS = 120.0
"""Longest query in windows, in seconds. Search for a longer motion with scope "clips"."""


def find_in_windows(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> HitPage:
    """Parts of clips, the most similar to a motion first.

    The index of clips must have caught up with the library. Raises BadField, ClipNotFound,
    ClipNotReady, and BadContent for an upload that cannot be used.
    """
    if method not in WINDOW_SCORES:
        known = ", ".join(WINDOW_SCORES)
        raise fields.bad_field("method", f"with scope windows it must be one of {known}")
    descriptors = describe(lib, query.source, (FEATURES,))
    query_segment = _query_segment(descriptors)
    excluded = None if query.include_self else descriptors.interval
    # An upload has no id: a cursor recognizes it by its features.
    content = hashlib.sha256(query_segment.features.tobytes()).hexdigest()
    question = cursors.digest(
        "windows", query.source.clip_id, content, method, clip_filter, excluded
    )
    paging = Paging.at(query.cursor, question, query.clip_fields, query.max_distance)
    candidates, anchor = _rank(lib, method, clip_filter, query_segment, excluded, paging.anchor)
    found, more = merge_overlapping(candidates, query.limit, paging.after)
    to_score = partial(score, scale=WINDOW_SCORES[method])
    return paging.hits(lib, MatchPage(matches_of(found), more, anchor), to_score)


def matches_of(found: Sequence[FoundInterval]) -> list[Match]:
    """The found parts of clips, as the matches of a page."""
    return [Match(part.clip_id, part.key, part.distance, part.start, part.end) for part in found]


def _rank(
    lib: Library,
    method: Method,
    clip_filter: ClipFilter,
    query_segment: QuerySegment,
    excluded: ExcludedInterval | None,
    anchor: Anchor | None,
) -> tuple[Candidates, Anchor | None]:
    load = partial(lib.arrays.get_many, lib.store)
    if method is Method.DTW:
        clips = lib.index.candidates(clip_filter)
        return by_warping(clips.ids, clips.seconds, query_segment, excluded, load), None
    windows = partial(_windows, lib, clip_filter)
    if method is Method.VECTOR:
        return by_windows(windows, query_segment, excluded), None
    return by_both(windows, query_segment, excluded, load, anchor)


def _windows(lib: Library, clip_filter: ClipFilter, scale: WindowScale) -> Parts:
    """All windows of one scale, of the clips that pass the filter."""
    index = lib.windows[scale.name]
    index.catch_up(lib.store)
    return Parts.of(index.state[1], clip_filter)


def _query_segment(query: QueryDescriptors) -> QuerySegment:
    seconds = query.seconds
    if seconds > MAX_SECONDS:
        limit = f"a search in windows takes at most {MAX_SECONDS:g} s"
        raise fields.bad_field("end", f"{limit}; start and end select {seconds:.1f} s")
    return QuerySegment(query.arrays[FEATURES], seconds)
