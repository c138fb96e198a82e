"""Find motions by several parts together: examples and words, for something or against it.

One part alone is ranked and scored as the search by example or by words does it.
"""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from app.errors import BadField
from app.kinedex_error import Place
from app.search.example.methods import Method
from app.services import fields
from app.services.find import find
from app.services.find.hits import Hit, Hits, PartScore, milliseconds_since
from app.services.find.paging import Match, MatchPage, Paging
from app.services.find.queries import ComposedQuery, Example, MotionQuery, WordQuery
from app.services.find.query_parts import QueryParts
from app.services.find.word_parts import WordParts
from app.services.library.filters import resolved_filter
from app.services.library.library import Library

MAX_EXAMPLES = 20
MAX_WEIGHT = 100.0
MINUS = "-"


def find_by_parts(lib: Library, query: ComposedQuery) -> Hits:
    """Clips that are like the examples for something and carry the words, without the others.

    The `method` of the result is that of the examples; the mode of words if there are only words.
    Each hit has the scores of the parts. Raises BadField, ClipNotFound, ClipNotReady, BadContent
    for an upload that cannot be used, ModelNotFitted, and NotEnoughLabels for the mode "cca".
    """
    checked = _checked(lib, query)
    if not checked.examples:
        return _by_words(lib, checked)
    if len(checked.examples) == 1 and not checked.words:
        return _by_example(lib, checked)
    return _by_all(lib, checked)


def _checked(lib: Library, query: ComposedQuery) -> ComposedQuery:
    """The query with its values checked and parsed. Raises BadField."""
    method, mode = find.motion_method(query.method), find.word_mode(query.mode)
    fields.limit(query.limit)
    # A blank text stays, so that the others keep their places in the query.
    words = tuple(fields.text("words", text) or "" for text in query.words)
    if words:
        fields.queried_words(words)
    for example in query.examples:
        if not (math.isfinite(example.weight) and 0.0 < example.weight <= MAX_WEIGHT):
            message = f"must be above 0 and at most {MAX_WEIGHT:g}"
            raise fields.bad_field(f"{example.part}.weight", message)
    if len(query.examples) > MAX_EXAMPLES:
        raise fields.bad_field("examples", f"must not be more than {MAX_EXAMPLES}")
    _check_is_for(query.examples, words)
    passing = resolved_filter(lib, query.filter)
    return replace(query, method=method, mode=mode, words=words, filter=passing)


def _check_is_for(examples: Sequence[Example], words: Sequence[str]) -> None:
    """Raises BadField for a query that is only against something."""
    is_for = any(not example.is_against for example in examples)
    if is_for or any(text and not text.startswith(MINUS) for text in words):
        return
    message = "at least one example, or a word without a minus, must be for something"
    places = [Place("examples", message), Place("words", message)]
    raise BadField("The query is for nothing.", places=places)


def _by_example(lib: Library, query: ComposedQuery) -> Hits:
    (example,) = query.examples
    found = find.find_motion(
        lib,
        MotionQuery(
            source=example.source,
            method=query.method,
            limit=query.limit,
            filter=query.filter,
            include_self=query.include_self,
            cursor=query.cursor,
            clip_fields=query.clip_fields,
        ),
    )
    items = tuple(
        replace(hit, parts=(PartScore(example.part, False, hit.score),)) for hit in found.items
    )
    return replace(found, items=items)


def _by_words(lib: Library, query: ComposedQuery) -> Hits:
    lib.index.catch_up(lib.store)
    clips = lib.index.state[1].labels
    asked = WordQuery(
        words=query.words,
        mode=query.mode,
        limit=query.limit,
        filter=query.filter,
        cursor=query.cursor,
        clip_fields=query.clip_fields,
    )
    found = find.find_words(lib, asked, clips)
    words = WordParts.of(lib, clips, query.words, query.mode)
    return replace(found, items=_with_word_scores(found.items, words))


def _by_all(lib: Library, query: ComposedQuery) -> Hits:
    began = time.perf_counter()
    version = lib.index.catch_up(lib.store)
    parts = QueryParts(lib, query)
    paging = Paging.at(query.cursor, parts.question, query.clip_fields)
    ranking, scales = parts.ranked(paging)
    page = ranking.page(paging.after, query.limit)
    matches = [
        Match(clip_id=str(clip_id), key=str(clip_id), distance=distance)
        for clip_id, distance in zip(page.ids, page.distances.tolist(), strict=True)
    ]
    found = paging.hits(lib, MatchPage(matches, page.more, ranking.anchor, scales), _score)
    items = tuple(replace(hit, parts=parts.example_scores(ranking, hit)) for hit in found.items)
    asked = parts.words.asked if parts.words else None
    return Hits(
        method=Method(query.method).value,
        took_ms=milliseconds_since(began),
        library_version=version,
        items=items if parts.words is None else _with_word_scores(items, parts.words),
        next=found.next,
        unknown_words=asked.unknown if asked else (),
        expanded=dict(asked.expanded) if asked else {},
        confidence=dict(asked.confidence) if asked else {},
    )


def _with_word_scores(hits: tuple[Hit, ...], words: WordParts) -> tuple[Hit, ...]:
    """The hits with the scores of the words behind those of the examples."""
    scores = words.scores(np.array([hit.clip.id for hit in hits], dtype=object))
    return tuple(replace(hit, parts=hit.parts + own) for hit, own in zip(hits, scores, strict=True))


def _score(distance: float) -> float:
    return math.exp(-distance)
