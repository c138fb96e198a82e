"""Find motions by several parts together: examples and words, for something or against it.

One part alone is ranked and scored as the search by example or by words does it, unless the hits
are arranged (`arrangement`) or counted: then it is one of several parts, so that its score is a
probability.
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
from app.services.find.arranging import checked_facets
from app.services.find.criteria import checked_weight
from app.services.find.hits import Hit, Hits, PartScore, milliseconds_since
from app.services.find.paging import Paging
from app.services.find.queries import ComposedQuery, MotionQuery, WordQuery
from app.services.find.query_parts import QueryParts
from app.services.find.word_parts import WordParts
from app.services.library.filters import resolved_filter
from app.services.library.library import Library

MAX_EXAMPLES = 20
MINUS = "-"


def find_by_parts(lib: Library, query: ComposedQuery) -> Hits:
    """Clips that are like the examples for something and carry the words, without the others.

    The `method` of the result is that of the examples; the mode of words if there are only words.
    Each hit has the scores of the parts. Raises BadField, ClipNotFound, ClipNotReady, BadContent
    for an upload that cannot be used, ModelNotFitted, and NotEnoughLabels for the mode "cca".
    """
    checked = _checked(lib, query)
    if _is_composed(checked):
        return _by_all(lib, checked)
    if not checked.examples:
        return _by_words(lib, checked)
    if len(checked.examples) == 1 and not checked.words:
        return _by_example(lib, checked)
    return _by_all(lib, checked)


def _is_composed(query: ComposedQuery) -> bool:
    """Whether a query asks for more than hits by examples of whole bodies and by words."""
    return bool(
        not query.arrangement.is_plain
        or query.facets
        or query.poses
        or query.rhythm
        or any(example.body_part for example in query.examples)
    )


def _checked(lib: Library, query: ComposedQuery) -> ComposedQuery:
    """The query with its values checked and parsed. Raises BadField."""
    method, mode = find.motion_method(query.method), find.word_mode(query.mode)
    fields.limit(query.limit)
    # A blank text stays, so that the others keep their places in the query.
    words = tuple(fields.text("words", text) or "" for text in query.words)
    if words:
        fields.queried_words(words)
    for example in query.examples:
        checked_weight(example.part, example.weight)
    if len(query.examples) > MAX_EXAMPLES:
        raise fields.bad_field("examples", f"must not be more than {MAX_EXAMPLES}")
    _check_is_for(query, words)
    query.arrangement.check()
    asked = checked_facets(query.facets)
    passing = resolved_filter(lib, query.filter)
    return replace(query, method=method, mode=mode, words=words, filter=passing, facets=asked)


def _check_is_for(query: ComposedQuery, words: Sequence[str]) -> None:
    """Raises BadField for a query that is only against something."""
    others = [one for one in (query.poses, query.rhythm) if one is not None]
    is_for = any(not one.is_against for one in (*query.examples, *others))
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
        replace(hit, parts=(PartScore(example.part, False, hit.score, hit.distance),))
        for hit in found.items
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
    costs = [hit.distance for hit in found.items]
    return replace(found, items=_with_word_scores(found.items, words, costs))


def _by_all(lib: Library, query: ComposedQuery) -> Hits:
    began = time.perf_counter()
    version = lib.index.catch_up(lib.store)
    parts = QueryParts(lib, query)
    paging = Paging.at(query.cursor, parts.question, query.clip_fields)
    ranking, scales = parts.ranked(paging)
    arranger = parts.arranger
    counted = arranger.count(ranking, parts.candidates)
    page = replace(arranger.page(ranking, paging, query.limit), scales=scales)
    found = paging.hits(lib, page, _score)
    items = tuple(
        replace(
            hit,
            parts=parts.example_scores(ranking, hit),
            group=arranger.group_of(hit.clip.id),
        )
        for hit in found.items
    )
    if parts.words is not None:
        costs = [ranking.costs(hit.clip.id)[-1] if parts.has_words else 0.0 for hit in items]
        items = _with_word_scores(items, parts.words, costs)
    asked = parts.words.asked if parts.words else None
    return Hits(
        method=Method(query.method).value if query.examples else query.mode,
        took_ms=milliseconds_since(began),
        library_version=version,
        items=items,
        next=found.next,
        unknown_words=asked.unknown if asked else (),
        expanded=dict(asked.expanded) if asked else {},
        confidence=dict(asked.confidence) if asked else {},
        facets=parts.facets(counted),
    )


def _with_word_scores(
    hits: tuple[Hit, ...], words: WordParts, costs: Sequence[float]
) -> tuple[Hit, ...]:
    """The hits with the scores of the words behind those of the examples.

    costs: what all words together add to each hit's distance.
    """
    scores = words.scores(np.array([hit.clip.id for hit in hits], dtype=object), costs)
    return tuple(replace(hit, parts=hit.parts + own) for hit, own in zip(hits, scores, strict=True))


def _score(distance: float) -> float:
    return math.exp(-distance)
