"""Find a motion among the segments of all clips: the segments that are most similar to it."""

from __future__ import annotations

from functools import partial

import numpy as np

from app.analysis.segments.segments import SEGMENT_SPANS, SEGMENT_VECTORS, segment_vectors
from app.numerics.arrays import BoolArray, FloatArray
from app.search.example.distances import FEATURES
from app.search.example.methods import Method
from app.search.ranking import cursor as cursors
from app.search.ranking.ranking import score
from app.search.windows.overlap_merging import Candidates, merge_overlapping
from app.search.windows.parts import Parts
from app.search.windows.proposals import ExcludedInterval
from app.services import fields
from app.services.find.hits import HitPage
from app.services.find.in_windows import matches_of
from app.services.find.paging import MatchPage, Paging
from app.services.find.queries import RANKED_BY_IN_SEGMENTS, MotionQuery
from app.services.find.query import describe
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.views.segments import segment_arrays
from app.store.clips.filter import ClipFilter

METHODS = (Method.FUSED, RANKED_BY_IN_SEGMENTS)
"""Both compare the vectors of segments. Time warping does not improve the ranking of motions that
are cut at their keyposes."""
SCORE_SCALE = 1.0
"""Distance at which the score is one half: about that of two segments of one task."""


def find_in_segments(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> HitPage:
    """Segments of clips, the most similar to a motion or to a segment of a stored clip first.

    The index of clips must have caught up with the library. Raises BadField, ClipNotFound,
    ClipNotReady, and BadContent for an upload that cannot be used.
    """
    if method not in METHODS:
        known = ", ".join(METHODS)
        raise fields.bad_field("method", f"with scope segments it must be one of {known}")
    if query.segment is None:
        vector, queried = _motion_as_segment(lib, query.source)
    else:
        vector, queried = _stored_segment(lib, query.source, query.segment)
    excluded = None if query.include_self else queried
    question = cursors.digest("segments", queried, vector.tobytes().hex(), clip_filter, excluded)
    paging = Paging.at(query.cursor, question, query.clip_fields, query.max_distance)
    candidates = _candidates(lib, vector, clip_filter, excluded)
    found, more = merge_overlapping(candidates, query.limit, paging.after)
    to_score = partial(score, scale=SCORE_SCALE)
    return paging.hits(lib, MatchPage(matches_of(found), more), to_score)


def _motion_as_segment(
    lib: Library, source: QuerySource
) -> tuple[FloatArray, ExcludedInterval | None]:
    """The vector of a whole motion as one segment, and its interval in a stored clip."""
    query = describe(lib, source, (FEATURES,))
    span = np.array([[0.0, query.seconds]])
    return segment_vectors(query.arrays[FEATURES], span)[0], query.interval


def _stored_segment(
    lib: Library, source: QuerySource, segment: int
) -> tuple[FloatArray, ExcludedInterval]:
    """The vector of a segment of a stored clip, and its interval."""
    if source.clip_id is None:
        raise fields.bad_field("segment", "is for a stored clip, not for an uploaded file")
    for name in ("start", "end"):
        if getattr(source, name) is not None:
            message = "cannot be used together with segment, which has its own start and end"
            raise fields.bad_field(name, message)
    found = segment_arrays(lib, ready_clip(lib, source.clip_id))
    spans = found[SEGMENT_SPANS]
    if not 0 <= segment < len(spans):
        message = f"the clip has {len(spans)} segments, counted from 0"
        raise fields.bad_field("segment", message)
    start, end = spans[segment].tolist()
    vector = found[SEGMENT_VECTORS][segment].astype(np.float32)
    return vector, ExcludedInterval(source.clip_id, start, end)


def _candidates(
    lib: Library, vector: FloatArray, clip_filter: ClipFilter, excluded: ExcludedInterval | None
) -> Candidates:
    """All segments of the clips that pass the filter, with their distances to `vector`."""
    lib.segments.catch_up(lib.store)
    parts = Parts.of(lib.segments.state[1], clip_filter)
    distances = parts.distances(vector[None])[0].astype(float)
    rows = np.flatnonzero(~_overlaps(parts, excluded))
    return Candidates(
        parts.ids, parts.owners[rows], parts.starts[rows], parts.ends[rows], distances[rows]
    )


def _overlaps(parts: Parts, excluded: ExcludedInterval | None) -> BoolArray:
    """(n,) whether a segment overlaps the excluded interval.

    The segments before and after the interval only touch it, and do not overlap it.
    """
    if excluded is None:
        return np.zeros(len(parts), dtype=bool)
    is_same_clip = (parts.ids == excluded.clip_id)[parts.owners]
    # 1 ms of tolerance: stored times are float32, and a client's times are rounded differently.
    is_inside = (parts.starts + 1e-3 < excluded.end) & (parts.ends - 1e-3 > excluded.start)
    return np.asarray(is_same_clip & is_inside)
