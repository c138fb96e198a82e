"""What a client can ask about how the hits of a search by several parts are arranged."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import StrEnum

from app.services.fields import bad_field


class GroupBy(StrEnum):
    """By what hits are put into groups."""

    PERSON = "person"
    TASK = "task"
    SOURCE = "source"
    DUPLICATES = "duplicates"
    """Groups of near-duplicates, see `services.curation.duplicates`."""


UNLABELED = ""
"""The name of the group of clips without a label."""


@dataclass(frozen=True, slots=True)
class Arrangement:
    """How hits are arranged.

    group_by: only the best hit of each group is shown. group: with group_by, the hits of this group
    instead, by its name. diversity: 0..1, above 0 the best SHORTLIST hits are put in an order in
    which neighbors are unlike each other, and the ranking ends after them. min_score: 0..1, only
    hits at least as good.
    """

    group_by: GroupBy | None = None
    group: str | None = None
    diversity: float = 0.0
    min_score: float = 0.0

    def check(self) -> None:
        """Raises BadField."""
        if self.group is not None and self.group_by is None:
            raise bad_field("group", "needs group_by")
        for name in ("diversity", "min_score"):
            if not 0.0 <= getattr(self, name) <= 1.0:
                raise bad_field(name, "must be from 0 to 1")

    @property
    def is_plain(self) -> bool:
        """Whether all hits are shown in the order of the ranking."""
        return self == Arrangement()

    @property
    def max_distance(self) -> float:
        """The distance of the worst hit: -ln of its score, and what rounding may add."""
        return math.inf if self.min_score == 0.0 else -math.log(self.min_score) + 1e-9


PLAIN = Arrangement()
