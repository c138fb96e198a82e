"""Answers: composed search. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass

from kinedex.records import Page, Record
from kinedex.types.choices import GroupBy
from kinedex.types.clips import Clip


@dataclass(frozen=True, slots=True)
class HitGroup(Record):
    """The group of a hit.

    value: Its name, for `group`: the label, or the id of a group of near-duplicates. An empty
    text for clips without the label; null for a clip without near-duplicates.
    count: Number of hits in the group.
    """

    by: GroupBy
    value: str | None
    count: int


@dataclass(frozen=True, slots=True)
class PartScore(Record):
    """How likely one part of a query is true of a hit.

    part: The part of the query: `examples.0` for the first example, `file` for the uploaded
    one, `poses`, `rhythm`, `words.0` for the first word.
    against: Whether the query is against it.
    score: Probability that the clip is like the example, or carries the words. For examples it
    comes from the distance, relative to the median distance in the library, by a curve that was
    fitted on real clips. Rounded to 4 decimals, because the calibration is not more exact. 0
    means very unlikely, not impossible.
    cost: What the part adds to the `distance` of the hit: of the 300 clips that are compared
    exactly, the costs of all parts sum to the distance. What several examples for something, or
    several words, cost together is divided in proportion to -ln(score) of each.
    """

    part: str
    against: bool
    score: float
    cost: float


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
    group: With group_by: its group.
    """

    rank: int
    score: float
    distance: float
    start: float
    end: float
    clip: Clip
    parts: list[PartScore]
    group: HitGroup | None


@dataclass(frozen=True, slots=True)
class FacetCount(Record):
    """A value, and the number of hits with it."""

    value: str
    count: int


@dataclass(frozen=True, slots=True)
class Facet(Record):
    """What the hits have of one label or measure.

    values: Of a label: the most frequent first, at most 100. Empty for a measure.
    others: Hits with values that are not listed.
    missing: Hits without the label or the measure.
    quartiles: Of a measure: (5,) the least value, the quartiles, and the largest value.
    """

    values: list[FacetCount]
    others: int
    missing: int
    quartiles: list[float] | None


@dataclass(frozen=True, slots=True)
class ComposedHits(Page[ComposedHit]):
    """A page of a ranking by several parts, the best first.

    method: The method of the examples; without one, the mode of words.
    facets: By name, over all hits on all pages; null if none was asked for.
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
    facets: dict[str, Facet] | None
    unknown_words: list[str]
    expanded: dict[str, list[str]]
    confidence: dict[str, float]
