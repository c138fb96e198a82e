"""Annotations that the models suggest for the parts of a clip that have none."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from app.analysis.descriptors.word_windows import WORD_WINDOW_SPANS, WORD_WINDOWS
from app.errors import ModelNotFitted
from app.formats.annotations.span import DECIMALS
from app.numerics.arrays import FloatArray
from app.search.windows.moments import STEP, on_grid
from app.search.windows.stretches import even_stretches
from app.services import fields
from app.services.annotations.clip_annotations import check_count
from app.services.find.query_source import QuerySource
from app.services.library.library import Library
from app.services.library.ready_clips import descriptors_of, ready_clip
from app.services.recognition.recognize import RecognizeQuery, recognize
from app.services.recognition.suggestions import LIKELY
from app.store import audit
from app.store.clips import clip_annotations as stored
from app.store.clips.clip_annotations import Annotation, NewAnnotation, Origin

MIN_SECONDS = 0.5
"""A shorter part is not suggested."""
MAX_SUGGESTED = 1000
MAX_RECOGNIZED = 30
"""Parts whose person is recognized, which takes 20 ms each: the longest ones."""
MIN_RECOGNIZED = 1.0
"""Seconds of a part whose person is recognized."""
SAME = 0.002
"""Seconds by which an accepted part may differ from the suggested one."""


@dataclass(frozen=True, slots=True)
class Suggested:
    """A part of a clip, in seconds, with the words that are likelier than not there.

    probability: of the likeliest word; person: None if it is not known.
    """

    start: float
    end: float
    words: tuple[str, ...]
    probability: float
    person: str | None = None
    person_probability: float | None = None


def suggest_annotations(lib: Library, clip_id: str) -> tuple[Suggested, ...]:
    """Parts of a clip without annotation, by start, with their words and person.

    Raises ClipNotFound, ClipNotReady, ModelNotFitted.
    """
    found = _worded(lib, clip_id)
    longest = sorted(found, key=lambda part: part.start - part.end)[:MAX_RECOGNIZED]
    return tuple(_with_person(lib, clip_id, one) if one in longest else one for one in found)


def accept_annotations(
    lib: Library,
    clip_id: str,
    parts: Sequence[tuple[float, float]] | None = None,
    by: str | None = None,
) -> tuple[Annotation, ...]:
    """Make annotations of suggestions, and return all annotations of the clip.

    parts: start and end of each accepted suggestion, by default of all. by: who accepts. Raises
    ClipNotFound, ClipNotReady, ModelNotFitted, and BadField for a part that is not suggested.
    """
    who = fields.text("by", by)
    suggested = suggest_annotations(lib, clip_id)
    chosen = suggested if parts is None else _chosen(suggested, parts)
    with lib.store.write() as tx:
        audit.note(annotations=len(chosen))
        check_count(stored.count(tx, clip_id) + len(chosen))
        for one in chosen:
            new = NewAnnotation(
                start=one.start,
                end=one.end,
                words=one.words,
                person=one.person,
                by=who,
                origin=Origin.SUGGESTION,
                probability=one.probability,
            )
            stored.add(tx, clip_id, new)
        return stored.of_clip(tx, clip_id)


def _chosen(
    suggested: Sequence[Suggested], parts: Sequence[tuple[float, float]]
) -> tuple[Suggested, ...]:
    found = []
    for number, (start, end) in enumerate(parts):
        same = [one for one in suggested if abs(one.start - start) + abs(one.end - end) < 2 * SAME]
        if not same:
            raise fields.bad_field(f"items.{number}", f"{start:g} to {end:g} s is not suggested")
        found.append(same[0])
    return tuple(dict.fromkeys(found))


def _worded(lib: Library, clip_id: str) -> tuple[Suggested, ...]:
    clip = ready_clip(lib, clip_id)
    model = lib.models.words(lib.store).model
    with lib.store.read() as tx:
        arrays = descriptors_of(tx, clip, (WORD_WINDOWS, WORD_WINDOW_SPANS))
        said = stored.of_clip(tx, clip_id)
    scores = model.word_scores(arrays[WORD_WINDOWS].astype(np.float64))
    likely = np.flatnonzero(scores.max(axis=0) >= LIKELY)
    if not len(likely):
        return ()
    spans = arrays[WORD_WINDOW_SPANS].astype(np.float64)
    curve = np.stack([_curve(clip_id, spans, scores[:, column]) for column in likely], axis=1)
    words = np.array(model.vocabulary.words, dtype=object)[likely]
    free = _free([(one.start, one.end) for one in said], clip.duration or float(spans.max()))
    return tuple(_parts(curve, words, free))[:MAX_SUGGESTED]


def _curve(clip_id: str, spans: FloatArray, values: FloatArray) -> FloatArray:
    ids, owners = np.array([clip_id], dtype=object), np.zeros(len(spans), dtype=np.int64)
    return on_grid(ids, owners, spans[:, 0], spans[:, 1], values).values


def _parts(
    curve: FloatArray, words: FloatArray, free: Sequence[tuple[float, float]]
) -> Iterator[Suggested]:
    """The parts of a clip in which some word is likely, and which are free of annotations.

    curve: (n, V) by step; words: (V,); free: (start, end) in seconds.
    """
    joined: list[tuple[int, int]] = []
    before: frozenset[int] = frozenset()
    for first, stop in even_stretches(curve):
        own = frozenset(np.flatnonzero(curve[first:stop].mean(axis=0) >= LIKELY).tolist())
        if own and own == before:
            joined[-1] = (joined[-1][0], stop)
        elif own:
            joined.append((first, stop))
        before = own
    for first, stop in joined:
        mean = curve[first:stop].mean(axis=0)
        order = np.argsort(-mean, kind="stable")
        named = tuple(str(words[column]) for column in order if mean[column] >= LIKELY)
        for start, end in _common(free, first * STEP, stop * STEP):
            yield Suggested(start, end, named, float(mean[order[0]]))


def _common(
    free: Sequence[tuple[float, float]], start: float, end: float
) -> Iterator[tuple[float, float]]:
    """What of a part is free, if it is long enough; milliseconds."""
    for first, last in free:
        low, high = round(max(first, start), DECIMALS), round(min(last, end), DECIMALS)
        if high - low >= MIN_SECONDS:
            yield low, high


def _free(taken: Sequence[tuple[float, float]], seconds: float) -> list[tuple[float, float]]:
    """The parts of 0 to `seconds` that no part `taken` covers."""
    found, at = [], 0.0
    for start, end in sorted(taken):
        if start > at:
            found.append((at, start))
        at = max(at, end)
    return [*found, (at, seconds)] if at < seconds else found


def _with_person(lib: Library, clip_id: str, part: Suggested) -> Suggested:
    """The part with the person that the recognizer knows, if it does and may say it."""
    if not lib.settings.recognize_persons or part.end - part.start < MIN_RECOGNIZED:
        return part
    try:
        source = QuerySource(clip_id, start=part.start, end=part.end)
        answer = recognize(lib, RecognizeQuery(source)).person
    except ModelNotFitted:
        return part
    if answer.label is None:
        return part
    return replace(part, person=answer.label, person_probability=float(answer.score))
