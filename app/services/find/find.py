"""Find motions by example and by words."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable
from functools import partial

from app.models.metric.learned_metric import INPUTS
from app.search.example.by_example import COMPARED, SCALES, rank_by_example
from app.search.example.distances import FEATURES
from app.search.example.methods import LEARNED, Method
from app.search.index.labels import LabelView
from app.search.ranking import cursor as cursors
from app.search.ranking.ranking import Ranked, score
from app.services import fields
from app.services.find.by_metric import rank_by_metric
from app.services.find.hits import HitPage, Hits, milliseconds_since
from app.services.find.in_windows import find_in_windows
from app.services.find.paging import Match, MatchPage, Paging
from app.services.find.queries import (
    RANKED_BY_IN_SEGMENTS,
    SCOPES,
    TEMPOS,
    WORD_MODES,
    MotionQuery,
    WordQuery,
)
from app.services.find.query import describe
from app.services.library.filters import resolved_filter
from app.services.library.library import Library
from app.services.volume_options import NORMALIZED_SCALE, STORED_VOLUMES
from app.store.clips.filter import ClipFilter


def find_motion(lib: Library, query: MotionQuery) -> Hits:
    """Clips, or parts of clips, the most similar to a motion first.

    Raises BadField, ClipNotFound, ClipNotReady, BadContent for an upload that cannot be used,
    and ModelNotFitted for a metric that is not learned yet.
    """
    began = time.perf_counter()
    method, clip_filter = motion_method(query.method), resolved_filter(lib, query.filter)
    fields.limit(query.limit)
    if query.scope not in SCOPES:
        raise fields.bad_field("scope", f"must be one of {', '.join(SCOPES)}")
    if query.tempo not in TEMPOS:
        raise fields.bad_field("tempo", f"must be one of {', '.join(TEMPOS)}")
    fields.max_distance(query.max_distance)
    query.volumes.check(method, query.scope)
    version = lib.index.catch_up(lib.store)
    ranked_by = RANKED_BY_IN_SEGMENTS if query.scope == "segments" else method
    page = _search(query, method)(lib, query, method, clip_filter)
    return Hits(ranked_by.value, milliseconds_since(began), version, page.items, page.next)


def find_words(lib: Library, query: WordQuery, clips: LabelView | None = None) -> Hits:
    """Clips, or parts of clips, in order of how well words describe them.

    clips: a view of the index, by default the present one. Words that the model does not know are
    left out, and reported in the result.
    Raises BadField, ModelNotFitted.
    """
    # Imported here, so that a search by example does not load the modules of words.
    from app.services.find.by_words import rank_by_words
    from app.services.find.words_in_parts import find_words_in_parts

    began = time.perf_counter()
    clip_filter = resolved_filter(lib, query.filter)
    texts, mode = fields.queried_words(query.words), word_mode(query.mode)
    fields.limit(query.limit)
    if query.scope not in SCOPES:
        raise fields.bad_field("scope", f"must be one of {', '.join(SCOPES)}")
    version = lib.index.catch_up(lib.store)
    if query.scope == "clips":
        clips = clips or lib.index.state[1].labels
        found = rank_by_words(lib, clips, texts, mode, clip_filter)
        question = cursors.digest("words", *texts, mode, clip_filter, found.model)
        paging = Paging.at(query.cursor, question, query.clip_fields)
        asked = found.asked
        page = _page(lib, found.ranking, paging, query.limit, found.to_score)
    else:
        parts = find_words_in_parts(lib, query, texts, clip_filter)
        asked, page = parts.asked, parts.page
    return Hits(
        method=mode,
        took_ms=milliseconds_since(began),
        library_version=version,
        items=page.items,
        next=page.next,
        unknown_words=asked.unknown,
        expanded=dict(asked.expanded),
        confidence=dict(asked.confidence),
    )


_Search = Callable[[Library, MotionQuery, Method, ClipFilter], HitPage]


def _search(query: MotionQuery, method: Method) -> _Search:
    """The search function for a query's scope and method."""
    if query.scope == "segments":
        # Imported here, so that other searches do not load the analysis.
        from app.services.find.in_segments import find_in_segments

        return find_in_segments
    if query.segment is not None:
        raise fields.bad_field("segment", "needs scope segments")
    if query.scope == "windows":
        return find_in_windows
    return _by_metric if method in LEARNED else _by_example


def _by_example(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> HitPage:
    if query.volumes != STORED_VOLUMES:
        return _by_volumes(lib, query, method, clip_filter)
    described = describe(lib, query.source, COMPARED)
    arrays = described.arrays
    # An upload has no id: the cursor identifies it by a hash of its descriptors.
    content = hashlib.sha256(arrays[FEATURES].tobytes()).hexdigest()
    paced = lib.paced if method is Method.FUSED and query.tempo == "any" else None
    question = cursors.digest(
        query.source.clip_id, content, method, clip_filter, query.include_self, paced is None
    )
    paging = Paging.at(query.cursor, question, query.clip_fields, query.max_distance)
    if paced is not None:
        paced.catch_up(lib.store)
    found = rank_by_example(
        lib.index,
        arrays,
        method,
        clip_filter,
        described.excluded_clips(include_self=query.include_self),
        partial(lib.arrays.get_many, lib.store),
        paging.anchor,
        paced,
    )
    return _page(lib, found, paging, query.limit, partial(score, scale=SCALES[method]))


def _by_volumes(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> HitPage:
    """By motion volumes that are compared in another way than the stored ones."""
    # Imported here, so that other searches do not load the analysis.
    from app.services.find.by_volumes import rank_by_volumes

    found = rank_by_volumes(lib, query, method, clip_filter)
    question = cursors.digest(found.digest, method, clip_filter, query.volumes)
    paging = Paging.at(query.cursor, question, query.clip_fields, query.max_distance)
    scale = NORMALIZED_SCALE if query.volumes.normalized else SCALES[method]
    return _page(lib, found.ranking, paging, query.limit, partial(score, scale=scale))


def _by_metric(
    lib: Library, query: MotionQuery, method: Method, clip_filter: ClipFilter
) -> HitPage:
    described = describe(lib, query.source, INPUTS)
    exclude = described.excluded_clips(include_self=query.include_self)
    found = rank_by_metric(lib, described.arrays, method, clip_filter, exclude)
    question = cursors.digest(
        query.source.clip_id, found.digest, method, clip_filter, query.include_self, found.model
    )
    paging = Paging.at(query.cursor, question, query.clip_fields, query.max_distance)
    return _page(lib, found.ranking, paging, query.limit, found.to_score)


def _page(
    lib: Library,
    ranking: Ranked,
    paging: Paging,
    limit: int,
    to_score: Callable[[float], float],
) -> HitPage:
    """One page of a ranking of whole clips."""
    page = ranking.page(paging.after, limit)
    matches = [
        Match(clip_id=str(clip_id), key=str(clip_id), distance=distance)
        for clip_id, distance in zip(page.ids, page.distances.tolist(), strict=True)
    ]
    return paging.hits(lib, MatchPage(matches, page.more, ranking.anchor), to_score)


def word_mode(mode: str) -> str:
    """A mode of searches by words. Raises BadField."""
    if mode not in WORD_MODES:
        raise fields.bad_field("mode", f"must be one of {', '.join(WORD_MODES)}")
    return mode


def motion_method(value: Method | str) -> Method:
    """A method of searches by example. Raises BadField."""
    try:
        return Method(value)
    except ValueError as problem:
        known = ", ".join(method.value for method in Method)
        raise fields.bad_field("method", f"must be one of {known}") from problem
