"""Opaque cursors that page through a ranking.

A cursor holds a digest of the query, and the rank, distance and clip id of the last hit of a page.
The next page begins behind that hit, so clips that arrive between two pages shift nothing. A cursor
of another query is refused. Where only a shortlist was ranked again, the cursor also holds where
the shortlist ended.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from app.errors import BadField, Place
from app.store.database import cursor_codec
from app.store.database.cursor_codec import as_count, as_number, as_text

MAX_RANK = 10**9


@dataclass(frozen=True, slots=True)
class Anchor:
    """Where a shortlist ended, so that the next page has the same shortlist.

    distance, clip_id: of its farthest clip before it was ranked again; end: the largest
    distance in it afterwards, behind which all other clips follow; None while pages are within
    the shortlist and not all of it was measured.
    """

    distance: float
    clip_id: str
    end: float | None


@dataclass(frozen=True, slots=True)
class Position:
    """The last hit that was seen: its rank (from 1), distance and clip id; see `Anchor`."""

    rank: int
    distance: float
    clip_id: str
    anchor: Anchor | None = None


def digest(*parts: object) -> str:
    """A short digest of what identifies a query: the same parts give the same digest."""
    text = json.dumps([str(part) for part in parts])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def encode(position: Position, query: str) -> str:
    """A cursor for what follows `position` in the answer to a query, given by its digest."""
    values: list[str | float | None] = [
        query, position.rank, position.distance, position.clip_id
    ]  # fmt: skip
    if (anchor := position.anchor) is not None:
        values += [anchor.distance, anchor.clip_id, anchor.end]
    return cursor_codec.encode(values)


def decode(cursor: str, query: str) -> Position:
    """The position in a cursor. Raises BadField if it is no cursor, or one of another query."""
    try:
        found, rank, distance, clip_id, *rest = cursor_codec.decode(cursor)
        anchor = _anchor(rest) if rest else None
        position = Position(as_count(rank, MAX_RANK), as_number(distance), as_text(clip_id), anchor)
    except ValueError as problem:
        raise _refused("this is not a cursor that was given out") from problem
    if found != query:
        raise _refused("this cursor belongs to another query")
    return position


def _anchor(values: list[object]) -> Anchor:
    distance, clip_id, end = values
    return Anchor(as_number(distance), as_text(clip_id), None if end is None else as_number(end))


def _refused(message: str) -> BadField:
    return BadField("The cursor cannot be used.", places=[Place("cursor", message)])
