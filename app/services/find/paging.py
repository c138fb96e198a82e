"""One page of a ranking: from the entries that were found to hits and the next cursor."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, replace

from app.search.ranking import cursor as cursors
from app.search.ranking.cursor import Anchor, Position
from app.services.find.hits import Hit, HitPage
from app.services.library.library import Library
from app.store.clips import repository as stored
from app.store.clips.partial import PartialClip
from app.store.clips.record import ClipRecord
from app.store.database.engine import Tx


@dataclass(frozen=True, slots=True)
class Match:
    """An entry of a ranking, before its clip is read.

    key: sorts matches of the same distance, and identifies a match in a cursor; start, end:
    seconds, the part that was found; end None: the clip's end; time: as in `Hit`.
    """

    clip_id: str
    key: str
    distance: float
    start: float = 0.0
    end: float | None = None
    time: float | None = None


@dataclass(frozen=True, slots=True)
class MatchPage:
    """The matches of one page, in order; more: whether others follow.

    anchor: see `Anchor`; scales: as in `Position`.
    """

    matches: Sequence[Match]
    more: bool
    anchor: Anchor | None = None
    scales: tuple[float, ...] = ()

    def within(self, max_distance: float) -> MatchPage:
        """The page of a ranking that ends at `max_distance`, inclusive."""
        near = [match for match in self.matches if match.distance <= max_distance]
        return self if len(near) == len(self.matches) else replace(self, matches=near, more=False)


@dataclass(frozen=True, slots=True)
class Paging:
    """The requested page of a ranking.

    question: digest of the query, which binds a cursor to it; after: the last hit of the page
    before, None for the first page; clip_fields: the fields of each hit's clip that are needed,
    None for all; max_distance: of the hits, None for any.
    """

    question: str
    after: Position | None
    clip_fields: frozenset[str] | None = None
    max_distance: float | None = None

    @classmethod
    def at(
        cls,
        cursor: str | None,
        question: str,
        clip_fields: frozenset[str] | None = None,
        max_distance: float | None = None,
    ) -> Paging:
        """The page at a client's cursor. Raises PageNotFound if the cursor is of another query."""
        if max_distance is not None:
            question = cursors.digest(question, max_distance)
        after = None if cursor is None else cursors.decode(cursor, question)
        return cls(question, after, clip_fields, max_distance)

    @property
    def anchor(self) -> Anchor | None:
        """The anchor that the cursor remembers, if any."""
        return self.after.anchor if self.after else None

    def hits(self, lib: Library, page: MatchPage, to_score: Callable[[float], float]) -> HitPage:
        """The matches as hits, with their clips as they are now.

        A match whose clip was deleted in the meantime is left out; it keeps its rank.
        to_score: from a distance to a score, 0..1.
        """
        if self.max_distance is not None:
            page = page.within(self.max_distance)
        before = self.after.rank if self.after else 0
        with lib.store.read() as tx:
            clips = self._clips(lib, tx, {match.clip_id: None for match in page.matches})
        items = tuple(
            _hit(rank, match, clip, to_score(match.distance))
            for rank, match in enumerate(page.matches, before + 1)
            if (clip := clips.get(match.clip_id)) is not None
        )
        if not page.more:
            return HitPage(items, None)
        last = page.matches[-1]
        rank = before + len(page.matches)
        position = Position(rank, last.distance, last.key, page.anchor, page.scales)
        return HitPage(items, cursors.encode(position, self.question))

    def _clips(
        self, lib: Library, tx: Tx, ids: Collection[str]
    ) -> Mapping[str, ClipRecord | PartialClip]:
        if self.clip_fields is None:
            return stored.get_many(tx, ids)
        return lib.kept_clips.read(tx, ids, self.clip_fields)


def _hit(rank: int, match: Match, clip: ClipRecord | PartialClip, score: float) -> Hit:
    duration = clip.duration or match.end or 0.0
    end = duration if match.end is None else min(match.end, duration)
    return Hit(rank, score, match.distance, match.start, end, clip, match.time)
