"""Reads a ranking page by page, as a client does with cursors."""

from __future__ import annotations

from collections.abc import Callable

from app.search.ranking.cursor import Position, decode, digest, encode
from app.search.ranking.ranking import Page, Ranked

QUESTION = digest("walking")


def cursor_behind(page: Page, ranked: Ranked, rank: int) -> Position:
    """The position after a page, encoded in a cursor and decoded."""
    last = Position(rank, float(page.distances[-1]), str(page.ids[-1]), ranked.anchor)
    return decode(encode(last, QUESTION), QUESTION)


def walk(rank_from: Callable[[Position | None], Ranked], size: int) -> list[Page]:
    """All pages; `rank_from` makes a new ranking for each page, from the position before it."""
    pages: list[Page] = []
    position: Position | None = None
    while True:
        ranked = rank_from(position)
        pages.append(ranked.page(position, size))
        assert len(pages[-1].ids) <= size
        if not pages[-1].more:
            return pages
        position = cursor_behind(pages[-1], ranked, sum(len(page.ids) for page in pages))


def walked(ranked: Ranked, size: int) -> list[str]:
    """The ids of all pages of one ranking."""
    return [str(clip_id) for page in walk(lambda _: ranked, size) for clip_id in page.ids]
