"""Find a step among the segments of all clips (DESIGN 8): which of them is danced alike."""

from __future__ import annotations

import numpy as np

from app.analysis.segments.segments import SEGMENT_SPANS, SEGMENT_VECTORS, segment_vectors
from app.numerics.arrays import BoolArray, FloatArray
from app.search.example.distances import FEATURES
from app.search.example.methods import Method
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Position
from app.search.windows.overlap_merging import Candidates, merge_overlapping
from app.search.windows.parts import Parts
from app.search.windows.proposals import ExcludedInterval
from app.services import fields
from app.services.find.hits import Hits
from app.services.find.in_windows import Paging, own_place, place_hits, seconds_of
from app.services.find.query import Question, describe
from app.services.library.library import Library
from app.services.library.ready_clips import ready_clip
from app.services.views.segments import segment_arrays
from app.store.clips.filter import ClipFilter

METHODS = (Method.FUSED, Method.VECTOR)
"""Both compare the segments' vectors: warping what is cut at its keyposes finds no more."""
SCORE_SCALE = 1.0
"""Distance at which the score is one half: about that of two segments of one task."""


def find_in_segments(
    lib: Library,
    question: Question,
    segment: int | None,
    method: Method,
    wanted: ClipFilter,
    paging: Paging,
) -> Hits:
    """Segments of clips in order of likeness to a motion, or to a segment of a stored clip,
    counted from 0; the index of clips has caught up.

    Raises BadField, ClipNotFound, ClipNotReady, and BadContent for an upload that cannot be
    used.
    """
    if method not in METHODS:
        known = ", ".join(METHODS)
        raise fields.bad_field("method", f"with scope segments it must be one of {known}")
    vector, own = _of_motion(lib, question) if segment is None else _own(lib, question, segment)
    excluded = None if paging.include_self else own
    fingerprint = cursors.digest("segments", own, vector.tobytes().hex(), wanted, excluded)
    after = None if paging.cursor is None else cursors.decode(paging.cursor, fingerprint)
    told, more = merge_overlapping(_candidates(lib, vector, wanted, excluded), paging.limit, after)
    rank = after.rank if after else 0
    following = None
    if more:
        last = Position(rank + len(told), told[-1].distance, told[-1].key)
        following = cursors.encode(last, fingerprint)
    hits = place_hits(lib, told, rank, SCORE_SCALE)
    return Hits(Method.VECTOR.value, 0.0, lib.index.version, hits, following)


def _of_motion(lib: Library, question: Question) -> tuple[FloatArray, ExcludedInterval | None]:
    """The vector of a motion taken as one segment, and its place in a stored clip."""
    asked = describe(lib, question, (FEATURES,))
    span = np.array([[0.0, seconds_of(asked, question)]])
    vector = segment_vectors(asked.arrays[FEATURES], span)[0]
    return vector, own_place(asked, question)


def _own(lib: Library, question: Question, segment: int) -> tuple[FloatArray, ExcludedInterval]:
    """The vector and the place of a segment of a stored clip."""
    if question.clip_id is None:
        raise fields.bad_field("segment", "goes with a stored clip, not with an uploaded file")
    for name in ("start", "end"):
        if getattr(question, name) is not None:
            raise fields.bad_field(name, "does not go with segment, which has its own")
    found = segment_arrays(lib, ready_clip(lib, question.clip_id))
    spans = found[SEGMENT_SPANS]
    if not 0 <= segment < len(spans):
        message = f"the clip has {len(spans)} segments, counted from 0"
        raise fields.bad_field("segment", message)
    start, end = spans[segment].tolist()
    vector = found[SEGMENT_VECTORS][segment].astype(np.float32)
    return vector, ExcludedInterval(question.clip_id, start, end)


def _candidates(
    lib: Library, vector: FloatArray, wanted: ClipFilter, excluded: ExcludedInterval | None
) -> Candidates:
    """All segments that are meant, with their distances."""
    lib.segments.catch_up(lib.store)
    parts = Parts.of(lib.segments.state[1], wanted)
    apart = parts.distances(vector[None])[0].astype(float)
    kept = np.flatnonzero(~_touching(parts, excluded))
    return Candidates(
        parts.ids, parts.owners[kept], parts.starts[kept], parts.ends[kept], apart[kept]
    )


def _touching(parts: Parts, excluded: ExcludedInterval | None) -> BoolArray:
    """(n,) whether a segment overlaps what is excluded; the next one, which only touches it, does
    not."""
    if excluded is None:
        return np.zeros(len(parts), dtype=bool)
    owned = (parts.ids == excluded.clip_id)[parts.owners]
    # the ends are float32, times that a client sends are not
    inside = (parts.starts + 1e-3 < excluded.end) & (parts.ends - 1e-3 > excluded.start)
    return np.asarray(owned & inside)
