"""Answers: studies. Generated from the OpenAPI description by `make client`."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime

from kinedex.records import Page, Record
from kinedex.types.choices import Choice


@dataclass(frozen=True, slots=True)
class Pair(Record):
    """Two low-dimensional versions of a clip, one from keyposes and one from uniform poses.

    The answer does not say which version is on which side.

    left: Path of the motion on the left.
    original: Path of the original, on the same joints.
    right: Path of the motion on the right.
    animation: Path of an animated picture of all three motions.
    votes: Path for POST of a vote.
    """

    id: str
    clip_id: str
    dimensions: int
    left: str
    original: str
    right: str
    animation: str
    votes: str
    created_at: datetime


@dataclass(frozen=True, slots=True)
class PairList(Page[Pair]):
    """A page of pairs, the newest first.

    next: Cursor of the next page, null on the last page.
    total: Number of items on all pages.
    total_is_exact: False if `total` is an estimate, as in lists of over 100,000 items. Its
    standard deviation is 1 %.
    """

    next: str | None
    total: int
    total_is_exact: bool
    items: list[Pair]


@dataclass(frozen=True, slots=True)
class SequenceTally(Record):
    """The votes on one clip with one model and one number of dimensions.

    keypose: Number of votes for the version from keyposes.
    same: Number of votes that both look the same.
    share: keypose / (keypose + uniform); null without any of these votes.
    interval: 95 % confidence interval of `share` (Wilson).
    chance: Probability of a share at least this far from one half if nobody saw a difference
    (exact binomial test, which assumes independent votes).
    """

    keypose: int
    uniform: int
    same: int
    share: float | None
    interval: list[float]
    chance: float
    clip_id: str
    name: str
    dimensions: int


@dataclass(frozen=True, slots=True)
class Tally(Record):
    """Votes as in Perera's Table 2.

    keypose: Number of votes for the version from keyposes.
    same: Number of votes that both look the same.
    share: keypose / (keypose + uniform); null without any of these votes.
    interval: 95 % confidence interval of `share` (Wilson).
    chance: Probability of a share at least this far from one half if nobody saw a difference
    (exact binomial test, which assumes independent votes).
    """

    keypose: int
    uniform: int
    same: int
    share: float | None
    interval: list[float]
    chance: float


@dataclass(frozen=True, slots=True)
class StudyTally(Record):
    """Table 2 of this library.

    sequences: The first 1000 by name. Use `clip_id` for others. `total` and `left_share` count
    all sequences.
    left_share: Share of votes for the left side; about one half is expected.
    """

    sequences: list[SequenceTally]
    total: Tally
    left_share: float | None


@dataclass(frozen=True, slots=True)
class Vote(Record):
    """A stored vote.

    The answer does not say which basis was chosen, because the voter may see more pairs.
    """

    id: str
    pair_id: str
    choice: Choice
