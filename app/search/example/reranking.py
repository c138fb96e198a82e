"""A ranking in two stages: the first clips, the shortlist, are ranked again by a costly distance.

The other clips follow in the order of the first stage. A cursor stores the end of the shortlist
(`Anchor`). So the next page has the same shortlist, also after clips were added and deleted.
Another view of the clips may add its nearest ones to the shortlist (`Guests`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cached_property

import numpy as np

from app.numerics.arrays import FloatArray
from app.numerics.nearest import DECIMALS
from app.search.example.guests import Guests
from app.search.ranking.cursor import Anchor, Position
from app.search.ranking.lower_bounds import LowerBoundRanking, LowerBounds
from app.search.ranking.ranking import FirstStage, IdArray, Page

STEP = 10.0**-DECIMALS
"""Added to the distances after the shortlist, so that each is larger than all in the shortlist."""

Rerank = Callable[[IdArray], LowerBounds]
"""Returns the clips (m,) of a shortlist with the distances of the second stage."""


class ShortlistRanking:
    """A ranking (see `ranking.Ranked`): a shortlist in its final order, then the other clips.

    The other clips have the order and the differences in distance of the first stage. A constant
    is added to their distances, so that they begin where the shortlist ends. This end is known
    only when all of the shortlist is measured. Until then, pages end in the shortlist.
    """

    def __init__(
        self,
        first: FirstStage,
        rerank: Rerank,
        size: int,
        anchor: Anchor | None = None,
        guests: Guests | None = None,
    ) -> None:
        """Prepare the ranking; distances are measured when a page is read.

        first: the first stage, of all clips. rerank: the second stage. size: of the shortlist.
        anchor: from the cursor of the page before, None for the first page. guests: clips that
        join the shortlist; `first` must rank them too.
        """
        self._first = first
        self._rerank = rerank
        self._size = size
        self._given = anchor
        self._guests = guests
        self._seen = 0.0  # the distance of the last clip on earlier pages

    def __len__(self) -> int:
        return len(self._first)

    @property
    def anchor(self) -> Anchor | None:
        """The end of the shortlist, as far as it is known; None for a ranking without clips."""
        given, shortlist = self._given, self._shortlist
        if given is not None and given.end is not None:
            return given
        if given is None and not len(shortlist.ids):
            return None
        end = self._head.end
        if end is not None:
            # Clips on earlier pages must not be farther than the clips of later pages.
            end = max(end, self._seen)
        if given is not None:
            return replace(given, end=end)
        last = float(shortlist.distances[-1]), str(shortlist.ids[-1])
        return Anchor(*last, end, self._last_guest)

    @property
    def ids(self) -> IdArray:
        """(n,) all clip ids in order."""
        return self._whole.ids

    @property
    def distances(self) -> FloatArray:
        """(n,) float64, never falling."""
        return self._whole.distances

    def page(self, after: Position | None, limit: int) -> Page:
        """The first `limit` clips after a position.

        There are three cases: a page in the shortlist, a page across its end, a page after it.
        """
        given = self._given
        if given is None and not len(self._shortlist.ids):
            return self._first.page(None, limit)
        if after is not None and given is not None and given.end is not None:
            shift = _shift(given, given.end)
            if after.distance > given.end:
                first_stage = np.round(after.distance - shift, DECIMALS)
                return self._rest(shift, Position(0, float(first_stage), after.clip_id), limit)
        self._seen = 0.0 if after is None else after.distance
        page = self._head.page(after, limit)
        if page.more:
            return page
        return self._filled(page, limit)

    def _filled(self, page: Page, limit: int) -> Page:
        """The last clips of the shortlist, and the next clips until the page is full."""
        anchor = self.anchor
        if anchor is None or anchor.end is None:  # impossible: all of the shortlist was measured
            return page
        last = Position(0, anchor.distance, anchor.clip_id)
        rest = self._rest(_shift(anchor, anchor.end), last, limit - len(page.ids))
        return Page(
            np.concatenate([page.ids, rest.ids]),
            np.concatenate([page.distances, rest.distances]),
            rest.more,
        )

    def _rest(self, shift: float, after: Position, limit: int) -> Page:
        """The clips after a position of the first stage, with final distances."""
        page = (
            self._first.page(after, limit)
            if self._guests is None
            else self._guests.page(self._outside, after, limit)
        )
        return Page(page.ids, np.round(page.distances + shift, DECIMALS), page.more)

    @cached_property
    def _whole(self) -> Page:
        return self.page(None, len(self))

    @cached_property
    def _shortlist(self) -> Page:
        if self._given is None:
            return self._first.page(None, self._size)
        return self._first.until(self._given.distance, self._given.clip_id)

    @cached_property
    def _invited(self) -> Page | None:
        """The clips of the other view; None without one."""
        given = self._given
        if self._guests is None or (given is not None and given.guest is None):
            return None
        return self._guests.invited(None if given is None else given.guest)

    @property
    def _last_guest(self) -> tuple[float, str] | None:
        invited = self._invited
        if invited is None or not len(invited.ids):
            return None
        return float(invited.distances[-1]), str(invited.ids[-1])

    @cached_property
    def _outside(self) -> IdArray:
        """The guests that are not among the first clips of the first stage."""
        if self._guests is None or self._invited is None:
            return np.array([], dtype=object)
        return self._guests.outside(self._invited.ids, set(self._shortlist.ids))

    @cached_property
    def _head(self) -> LowerBoundRanking:
        ids = np.concatenate([self._shortlist.ids, self._outside])
        clips, given = self._rerank(ids), self._given
        if given is None or given.end is None:
            return LowerBoundRanking(clips)
        # New clips must not get larger distances than the clips after the shortlist.
        return LowerBoundRanking(clips, max_distance=given.end)


def _shift(anchor: Anchor, end: float) -> float:
    """The number to add to distances of the first stage, after a shortlist that ends at `end`."""
    return end + STEP - anchor.distance
