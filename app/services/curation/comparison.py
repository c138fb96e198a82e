"""Compares new clips with all others, and stores the pairs that are near-duplicates."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping

import numpy as np

from app.numerics.arrays import FloatArray, IntArray
from app.search.duplicates.candidates import Candidate, by_moments, by_vectors
from app.search.duplicates.kinds import ClipFacts, kind_of
from app.search.duplicates.overlay import mirrored_features, overlay
from app.search.index.rows import RowsView
from app.services.library.library import Library
from app.store.clips import arrays, partial
from app.store.clips import versions as library
from app.store.curation import pairs as stored
from app.store.curation.pairs import DuplicatePair
from app.store.jobs import repository as jobs
from app.store.jobs.record import JobKind, JobState

FEATURES = "features_10hz"
CHUNK = 20_000
"""Clips for which candidates are looked for at a time: most of the work is shared by all."""

STORED_AT_ONCE = 250
"""Clips whose pairs are stored in one transaction."""

_FACTS = ("duration", "frame_rate", "format", "joints")

Pairs = dict[tuple[str, str], set[bool]]
"""Pairs of ids, the smaller first, each with the ways to compare it: mirrored, or as it is."""


def unchanged_version(lib: Library) -> int:
    """The version of the library: while it is the same, no other clip waits for a comparison."""
    with lib.store.read() as tx:
        return library.version(tx)


def is_any_waiting(lib: Library) -> bool:
    """Whether clips wait for a comparison."""
    with lib.store.read() as tx:
        return bool(stored.pending(tx, 1))


def is_analyzing(lib: Library) -> bool:
    """Whether clips wait for their analysis, which goes first."""
    with lib.store.read() as tx:
        states = (JobState.QUEUED, JobState.PROCESSING)
        open_ingests = (jobs.list_jobs(tx, kind=JobKind.INGEST, state=s, limit=1) for s in states)
        return any(page.items for page in open_ingests)


def compare_pending(lib: Library, limit: int = CHUNK) -> Iterator[int]:
    """Compare up to `limit` clips that changed; yields the number of stored ones as it grows.

    Every step is one transaction, so a caller may stop between two.
    """
    with lib.store.read() as tx:
        waiting = stored.pending(tx, limit)
        known = stored.partners(tx, waiting)
    if not waiting:
        return
    found = _candidates(lib, waiting)
    for pair in known:
        found.setdefault(pair, set()).update((False, True))
    by_clip: dict[str, list[tuple[str, str]]] = {clip_id: [] for clip_id in waiting}
    for pair in found:
        # in the step of one of its clips that waits; it is stored once
        by_clip[pair[0] if pair[0] in by_clip else pair[1]].append(pair)
    ids, done = list(waiting), 0
    verified: dict[tuple[str, str], DuplicatePair] = {}
    for first in range(0, len(ids), STORED_AT_ONCE):
        some = ids[first : first + STORED_AT_ONCE]
        step = {pair: found[pair] for clip_id in some for pair in by_clip[clip_id]}
        verified |= {pair.ids: pair for pair in _verified(lib, step)}
        # a clip's pairs are replaced in its own step: those that an earlier step stored too
        mine = [pair for pair in verified.values() if not set(pair.ids).isdisjoint(some)]
        with lib.store.write() as tx:
            stored.put(tx, {clip_id: waiting[clip_id] for clip_id in some}, mine)
        done += len(some)
        yield done


def _candidates(lib: Library, clip_ids: Collection[str]) -> Pairs:
    """The pairs to look at more closely."""
    found: Pairs = {}
    for index, find in ((lib.index, _near_vectors), (lib.moments, _near_moments)):
        index.catch_up(lib.store)
        view = index.state[1]
        for candidate in find(view, _numbers(view, clip_ids)):
            one, other = (view.labels.ids[n] for n in (candidate.one, candidate.other))
            found.setdefault((min(one, other), max(one, other)), set()).add(candidate.is_mirrored)
    return found


def _numbers(view: RowsView, clip_ids: Collection[str]) -> IntArray:
    numbers = view.labels.find(np.array(list(clip_ids), dtype=object))
    return np.asarray(numbers[numbers >= 0])


def _near_vectors(view: RowsView, asked: IntArray) -> Iterable[Candidate]:
    living = np.flatnonzero(view.labels.alive)
    return _named(by_vectors(_rows(view, living), np.searchsorted(living, asked)), living)


def _near_moments(view: RowsView, asked: IntArray) -> Iterable[Candidate]:
    if view.owners is None or not len(asked):
        return ()
    rows = np.flatnonzero(view.labels.alive[view.owners])
    return by_moments(_rows(view, rows), view.owners[rows].astype(np.int64), asked)


def _named(found: Iterable[Candidate], numbers: IntArray) -> Iterator[Candidate]:
    for one in found:
        yield Candidate(int(numbers[one.one]), int(numbers[one.other]), one.is_mirrored)


def _rows(view: RowsView, rows: IntArray) -> FloatArray:
    return view.vectors(rows)


def _verified(lib: Library, pairs: Mapping[tuple[str, str], set[bool]]) -> Iterator[DuplicatePair]:
    """The pairs that are near-duplicates, each with its best evidence."""
    ids = sorted({clip_id for pair in pairs for clip_id in pair})
    with lib.store.read() as tx:
        facts = {
            clip_id: ClipFacts(
                clip.duration or 0.0, clip.frame_rate or 1.0, clip.format or "", clip.joints or 0
            )
            for clip_id, clip in partial.read(tx, ids, _FACTS).items()
        }
        features = arrays.get_many(tx, ids, FEATURES)
    for (one, other), ways in pairs.items():
        if not {one, other} <= facts.keys() & features.keys():
            continue
        tried = [
            pair
            for is_mirrored in sorted(ways)
            if (pair := _compared(one, other, facts, features, is_mirrored=is_mirrored))
        ]
        if tried:
            yield min(tried, key=lambda pair: pair.distance)


def _compared(
    one: str,
    other: str,
    facts: Mapping[str, ClipFacts],
    features: Mapping[str, FloatArray],
    *,
    is_mirrored: bool,
) -> DuplicatePair | None:
    second = mirrored_features(features[other]) if is_mirrored else features[other]
    found = overlay(features[one], second)
    if found is None:
        return None
    kind = kind_of(facts[one], facts[other], found, is_mirrored=is_mirrored)
    if kind is None:
        return None
    return DuplicatePair(
        clip_id=one,
        other_id=other,
        kind=kind.value,
        distance=found.distance,
        offset=found.offset,
        shift=found.shift,
        seconds=found.seconds,
        is_mirrored=is_mirrored,
    )
