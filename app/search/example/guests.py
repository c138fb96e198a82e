"""Clips that another view of the motions adds to a shortlist.

The first stage compares motions at their own tempo. So the original of a clip that is played
slowly may be far down there, but it is among the nearest at a common pace.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from app.search.index.nearest_ranking import NearestRanking
from app.search.ranking.cursor import Position
from app.search.ranking.ranking import IdArray, Page

GUESTS = 60
"""Number of nearest clips of the other view. For 70 queries, the original was among them (or among
the 30 nearest of the first stage) in all cases but one, whatever was done to the query."""


@dataclass(frozen=True, slots=True)
class Guests:
    """The first stage of a shortlist, and the same clips ranked by another view."""

    first: NearestRanking
    view: NearestRanking

    def invited(self, last: tuple[float, str] | None) -> Page:
        """The nearest clips of the view; last: the distance and the id of the last of them, from
        the cursor of the page before. So the next page has the same guests."""
        return self.view.page(None, GUESTS) if last is None else self.view.until(*last)

    def outside(self, invited: IdArray, shortlist: Collection[str]) -> IdArray:
        """The invited clips that the first stage ranks, but that are not in its shortlist."""
        ranked = invited[self.first.among(invited)]
        return np.array([one for one in ranked if one not in shortlist], dtype=object)

    def page(self, guests: IdArray, after: Position, limit: int) -> Page:
        """The first `limit` clips of the first stage after a position, without the guests."""
        others = self.first.without(guests) if len(guests) else self.first
        return others.page(after, limit)
