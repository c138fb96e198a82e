"""Find motions by example and by words (DESIGN 7, 8)."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from app.models.metric.learned_metric import INPUTS
from app.search.example.by_example import SCALES, rank_by_example
from app.search.example.distances import EPSILON, FEATURES, RHO, QueryArrays
from app.search.example.methods import LEARNED, Method
from app.search.index.filters import as_filter
from app.search.index.vector_index import VECTOR
from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import Ranked, score
from app.services import fields
from app.services.find.by_metric import rank_by_metric
from app.services.find.by_words import WORD_MODES, rank_by_words
from app.services.find.hits import Hit, Hits
from app.services.find.in_segments import find_in_segments
from app.services.find.in_windows import Paging, find_in_windows
from app.services.find.query import Answered, Question, describe
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.clips.filter import ClipFilter
from app.store.files.files import Readable

DEFAULT_LIMIT = 10
SCOPES = ("clips", "windows", "segments")
_NAMES = (VECTOR, FEATURES, RHO, EPSILON)

Filter = ClipFilter | Mapping[str, Any] | None
"""A filter that was read, or as a client sent it, or none."""


@dataclass(frozen=True, slots=True)
class MotionQuery:
    """A search by example: exactly one of `clip_id` and `content`.

    start, end: seconds, the part of the query that is meant; skeleton, frame_rate (Hz), unit,
    roles, stack: of an uploaded query; limit: 1 to 1,000; scope: whether clips are compared as
    they are, or parts of them found, wherever they stand in it ("windows"), or what lies
    between keyposes ("segments"); segment: with that scope, the clip's own one as the query.
    """

    clip_id: str | None = None
    content: Readable | None = None
    start: float | None = None
    end: float | None = None
    method: Method | str = Method.FUSED
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    scope: str = "clips"
    include_self: bool = False
    cursor: str | None = None
    skeleton: Readable | None = None
    frame_rate: float | str | None = None
    unit: float | str | None = None
    roles: Mapping[str, str] | None = None
    stack: str | None = None
    segment: int | None = None


@dataclass(frozen=True, slots=True)
class WordQuery:
    """A search by words: mode "default" (kernel ridge) or "cca" (Takano's correlated space).

    words: words, phrases or sentences; one with a minus before it (-left) is to be left out.
    """

    words: Sequence[str]
    mode: str = "default"
    limit: int = DEFAULT_LIMIT
    filter: Filter = None
    cursor: str | None = None


def find_motion(lib: Library, query: MotionQuery) -> Hits:
    """Clips, or parts of clips, in order of likeness to a motion.

    Raises BadField, ClipNotFound, ClipNotReady, BadContent for an upload that cannot be used,
    and ModelNotFitted for a metric that is not learned yet.
    """
    began = time.perf_counter()
    method, wanted = _method(query.method), as_filter(query.filter)
    _check(query.limit, query.scope)
    version = lib.index.catch_up(lib.store)
    paging = Paging(query.limit, query.cursor, query.include_self)
    if query.scope == "segments":
        steps = find_in_segments(lib, _question(query), query.segment, method, wanted, paging)
        return _timed(steps, began)
    if query.segment is not None:
        raise fields.bad_field("segment", "goes with scope segments")
    if query.scope == "windows":
        return _timed(find_in_windows(lib, _question(query), method, wanted, paging), began)
    page = (_by_metric if method in LEARNED else _by_example)(lib, query, method, wanted)
    return _timed(replace(page, method=method.value, library_version=version), began)


def _by_example(lib: Library, query: MotionQuery, method: Method, wanted: ClipFilter) -> Hits:
    asked = describe(lib, _question(query), _NAMES)
    question = _fingerprint(asked, method, wanted, query)
    after = _position(query.cursor, question)
    found = rank_by_example(
        lib.index,
        _query_arrays(asked),
        method,
        wanted,
        _left_out(query),
        partial(lib.arrays.get_many, lib.store),
        after.anchor if after else None,
    )
    return _page(lib, found, question, query.limit, after, partial(score, scale=SCALES[method]))


def _by_metric(lib: Library, query: MotionQuery, method: Method, wanted: ClipFilter) -> Hits:
    asked = describe(lib, _question(query), INPUTS)
    found = rank_by_metric(lib, asked.arrays, method, wanted, _left_out(query))
    question = cursors.digest(
        query.clip_id, found.digest, method, wanted, query.include_self, found.model
    )
    after = _position(query.cursor, question)
    return _page(lib, found.ranking, question, query.limit, after, found.to_score)


def find_words(lib: Library, query: WordQuery) -> Hits:
    """Clips in order of how well words describe them.

    Raises BadField, ModelNotFitted. Words that the model does not know are told, and left out.
    """
    began = time.perf_counter()
    wanted = as_filter(query.filter)
    texts = fields.queried_words(query.words)
    if query.mode not in WORD_MODES:
        raise fields.bad_field("mode", f"must be one of {', '.join(WORD_MODES)}")
    _check(query.limit, "clips")
    version = lib.index.catch_up(lib.store)
    found = rank_by_words(lib, texts, query.mode, wanted)
    question = cursors.digest("words", *texts, query.mode, wanted, found.model)
    after = _position(query.cursor, question)
    page = _page(lib, found.ranking, question, query.limit, after, found.to_score)
    page = replace(
        page,
        method=query.mode,
        library_version=version,
        unknown_words=found.asked.unknown,
        expanded=dict(found.asked.expanded),
    )
    return _timed(page, began)


def _question(query: MotionQuery) -> Question:
    return Question(
        clip_id=query.clip_id,
        content=query.content,
        start=query.start,
        end=query.end,
        skeleton=query.skeleton,
        frame_rate=query.frame_rate,
        unit=query.unit,
        roles=query.roles,
        stack=query.stack,
    )


def _left_out(query: MotionQuery) -> frozenset[str]:
    return frozenset({query.clip_id} if query.clip_id and not query.include_self else ())


def _query_arrays(asked: Answered) -> QueryArrays:
    vector, features, rho, epsilon = (asked.arrays[name] for name in _NAMES)
    return QueryArrays(vector, features, rho, epsilon)


def _fingerprint(asked: Answered, method: Method, wanted: ClipFilter, query: MotionQuery) -> str:
    """What binds a cursor to its question; an upload is known by its descriptors."""
    content = hashlib.sha256(asked.arrays[FEATURES].tobytes()).hexdigest()
    return cursors.digest(query.clip_id, content, method, wanted, query.include_self)


def _position(cursor: str | None, question: str) -> Position | None:
    return None if cursor is None else cursors.decode(cursor, question)


def _page(
    lib: Library,
    found: Ranked,
    question: str,
    limit: int,
    after: Position | None,
    to_score: Callable[[float], float],
) -> Hits:
    """One page of a ranking, its clips as they are now; those deleted meanwhile are left out."""
    page = found.page(after, limit)
    rank = after.rank if after else 0
    ids, distances = [str(clip_id) for clip_id in page.ids], page.distances.tolist()
    with lib.store.read() as tx:
        clips = stored.get_many(tx, ids)
    hits = [
        Hit(place, to_score(distance), distance, 0.0, clip.duration or 0.0, clip)
        for place, (clip_id, distance) in enumerate(zip(ids, distances, strict=True), rank + 1)
        if (clip := clips.get(clip_id)) is not None
    ]
    if not page.more:
        return Hits("", 0.0, 0, tuple(hits))
    last = Position(rank + len(ids), distances[-1], ids[-1], found.anchor)
    return Hits("", 0.0, 0, tuple(hits), cursors.encode(last, question))


def _method(value: Method | str) -> Method:
    try:
        return Method(value)
    except ValueError as problem:
        known = ", ".join(method.value for method in Method)
        raise fields.bad_field("method", f"must be one of {known}") from problem


def _check(limit: int, scope: str) -> None:
    fields.limit(limit)
    if scope not in SCOPES:
        raise fields.bad_field("scope", f"must be one of {', '.join(SCOPES)}")


def _timed(hits: Hits, began: float) -> Hits:
    return replace(hits, took_ms=(time.perf_counter() - began) * 1000.0)
