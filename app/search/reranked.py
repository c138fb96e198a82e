"""A ranking whose first clips are ranked again, by what is too dear to compare all with.

The rest follows in the order of the first stage. A cursor remembers where the shortlist
ended (`Anchor`), so that it is the same on the next page although clips came and went.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.nearest import DECIMALS
from app.search.cursor import Anchor, Position
from app.search.near import Near
from app.search.rank import IdArray, Page, Ranking

STEP = 10.0**-DECIMALS
"""Between the last of the shortlist and what follows, so that a distance tells them apart."""

Rerank = Callable[[Page], Ranking]
"""Ranks a shortlist anew; clips that are gone meanwhile are left out."""


class ReRanked:
    """A ranking (see `rank.Ranked`): a shortlist in its final order, the rest behind it.

    The rest keeps the order and the spacing of the first stage, shifted to begin where the
    shortlist ends.
    """

    def __init__(
        self, first: Near, rerank: Rerank, size: int, anchor: Anchor | None = None
    ) -> None:
        """first: all clips; size: of the shortlist; anchor: of the cursor that goes on."""
        self._first = first
        self._rerank = rerank
        self._size = size
        self._given = anchor

    def __len__(self) -> int:
        return len(self._first)

    @cached_property
    def anchor(self) -> Anchor | None:
        """Where the shortlist ends; None where there is no clip."""
        if self._given is not None or not len(self._shortlist.ids):
            return self._given
        distance, clip_id = self._shortlist.distances[-1], self._shortlist.ids[-1]
        end = float(np.max(self._head.distances, initial=0.0))
        return Anchor(float(distance), str(clip_id), end)

    @property
    def ids(self) -> IdArray:
        """(n,) all clip ids in order."""
        return self._whole.ids

    @property
    def distances(self) -> FloatArray:
        """(n,) float64, never falling."""
        return self._whole.distances

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips behind a position."""
        anchor = self.anchor
        if anchor is None:
            return self._first.page(None, limit)
        if after is not None and after.distance > anchor.end:
            first_stage = np.round(after.distance - _shift(anchor), DECIMALS)
            return self._rest(anchor, Position(0, float(first_stage), after.clip_id), limit)
        page = self._head.page(after, limit)
        if page.more:
            return page
        behind = Position(0, anchor.distance, anchor.clip_id)
        rest = self._rest(anchor, behind, limit - len(page.ids))
        return Page(
            np.concatenate([page.ids, rest.ids]),
            np.concatenate([page.distances, rest.distances]),
            rest.more,
        )

    def _rest(self, anchor: Anchor, behind: Position, limit: int) -> Page:
        """What follows a position of the first stage, with final distances."""
        page = self._first.page(behind, limit)
        return Page(page.ids, np.round(page.distances + _shift(anchor), DECIMALS), page.more)

    @cached_property
    def _whole(self) -> Page:
        return self.page(None, len(self))

    @cached_property
    def _shortlist(self) -> Page:
        if self._given is None:
            return self._first.page(None, self._size)
        return self._first.until(self._given.distance, self._given.clip_id)

    @cached_property
    def _head(self) -> Ranking:
        head = self._rerank(self._shortlist)
        if self._given is None:
            return head
        # What came since the first page must not overtake what follows the shortlist.
        return Ranking(head.ids, np.minimum(head.distances, self._given.end))


def _shift(anchor: Anchor) -> float:
    """From a distance of the first stage to the final one, behind the shortlist."""
    return anchor.end + STEP - anchor.distance
