"""Answers: composed search. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class PartScore(Record):
    """How likely one part of a query is true of a hit.

    part: The part of the query: `examples.0` for the first example, `file` for the uploaded
    one, `words.0` for the first word.
    against: Whether the query is against it.
    score: Probability that the clip is like the example, or carries the words. For examples it
    comes from the distance, relative to the median distance in the library, by a curve that was
    fitted on real clips. Rounded to 4 decimals, because the calibration is not more exact. 0
    means very unlikely, not impossible.
    """

    part: str
    against: bool
    score: float


@dataclass(frozen=True, slots=True)
class ComposedHit(Record):
    """One hit of a search by several parts.

    score: Weighted geometric mean of the probabilities that the clip is of the kind of the
    examples for something (the mean of their log odds), that it carries the words, and that it
    is not like each example against something. One part alone has the score of its own search.
    distance: -ln(score), and a constant more behind the 300 clips that are compared exactly.
    One part alone has the distance of its own search.
    start: Start of the found part, seconds from the start of the clip. 0 with scope clips.
    end: End of the found part, seconds.
    parts: What each part says. A word without a meaning in this library is left out.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: Clip
    parts: list[PartScore]


@dataclass(frozen=True, slots=True)
class ComposedHits(Page[ComposedHit]):
    """A page of a ranking by several parts, the best first.

    method: The method of the examples; without one, the mode of words.
    unknown_words: Words that no clip carries.
    expanded: For each word that no clip carries, the words that were used instead: words of the
    library, or a detector of what the word names (`left foot moves`).
    confidence: For each word of `expanded`, how sure it is that the replacement means the same:
    1 for another form of the word. Scores are multiplied by it.
    """

    method: str
    took_ms: float
    library_version: int
    items: list[ComposedHit]
    next: str | None
    unknown_words: list[str]
    expanded: dict[str, list[str]]
    confidence: dict[str, float]
