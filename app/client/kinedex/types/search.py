"""Answers: search. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class Hit(Record):
    """One hit of a search.

    score: Higher is closer.
    distance: Its unit depends on the search; `max_distance` of a search by example names those
    of the methods.
    start: Start of the found part, seconds from the start of the clip. 0 with scope clips.
    end: End of the found part, seconds.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: Clip


@dataclass(frozen=True, slots=True)
class MotionHits(Page[Hit]):
    """A page of a ranking, the nearest first."""

    method: str
    took_ms: float
    library_version: int
    items: list[Hit]
    next: str | None


@dataclass(frozen=True, slots=True)
class WordHit(Record):
    """One hit of a search by words.

    score: Probability that the clip carries all requested words. It is calibrated on held-out
    clips, so that scores of different queries can be compared. If a word is replaced by others
    because no clip carries it, the most probable of them counts, reduced by the distance
    between the two meanings. Rounded to 4 decimals, because the calibration is not more exact.
    0 means very unlikely, not impossible.
    distance: -ln(score) in mode default; 1 - cosine, 0 to 2, in mode cca; Euclidean in mode
    printed.
    start: Start of the found part, seconds from the start of the clip. 0 with scope clips.
    end: End of the found part, seconds.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: Clip


@dataclass(frozen=True, slots=True)
class WordHits(Page[WordHit]):
    """A page of a ranking by words, the most probable first.

    unknown_words: Words that no clip carries.
    expanded: For each word that no clip carries, the words that were used instead: words of the
    library, or a detector of what the word names (`left foot moves`).
    confidence: For each word of `expanded`, how sure it is that the replacement means the same:
    1 for another form of the word. Scores are multiplied by it.
    """

    method: str
    took_ms: float
    library_version: int
    items: list[WordHit]
    next: str | None
    unknown_words: list[str]
    expanded: dict[str, list[str]]
    confidence: dict[str, float]
