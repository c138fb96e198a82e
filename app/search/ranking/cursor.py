"""Opaque cursors that page through a ranking.

A cursor contains a digest of the query, and the rank, distance and clip id of the last hit of a
page. The next page begins after that hit. So clips that are added between two pages do not shift
the other hits. A cursor of another query is refused. If a shortlist was ranked again, the cursor
also contains the end of the shortlist.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from app.errors import BadField
from app.kinedex_error import Place
from app.store.database import cursor_codec
from app.store.database.cursor_codec import as_count, as_number, as_text

MAX_RANK = 10**9
"""The largest rank in a valid cursor."""


@dataclass(frozen=True, slots=True)
class Anchor:
    """The end of a shortlist, so that the next page has the same shortlist.

    distance, clip_id: of the farthest clip of the shortlist, before it was ranked again. end: the
    largest distance in the shortlist afterwards; all other clips are farther. It is None until
    the whole shortlist is measured.
    """

    distance: float
    clip_id: str
    end: float | None


@dataclass(frozen=True, slots=True)
class Position:
    """The last hit of a page: its rank (from 1), distance and clip id; anchor: see `Anchor`."""

    rank: int
    distance: float
    clip_id: str
    anchor: Anchor | None = None


def digest(*parts: object) -> str:
    """A short digest of the parts that identify a query. Equal parts have the same digest."""
    text = json.dumps([str(part) for part in parts])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def encode(position: Position, query: str) -> str:
    """The cursor for the page after `position`; query: the digest of the query."""
    values: list[str | float | None] = [
        query, position.rank, position.distance, position.clip_id
    ]  # fmt: skip
    if (anchor := position.anchor) is not None:
        values += [anchor.distance, anchor.clip_id, anchor.end]
    return cursor_codec.encode(values)


def decode(cursor: str, query: str) -> Position:
    """The position in a cursor; query: the digest of the query.

    Raises BadField if `cursor` is not a cursor, or the cursor of another query.
    """
    try:
        own_query, rank, distance, clip_id, *rest = cursor_codec.decode(cursor)
        anchor = _anchor(rest) if rest else None
        position = Position(as_count(rank, MAX_RANK), as_number(distance), as_text(clip_id), anchor)
    except ValueError as problem:
        raise _refused("this is not a cursor of this server") from problem
    if own_query != query:
        raise _refused("this cursor belongs to another query")
    return position


def _anchor(values: list[object]) -> Anchor:
    distance, clip_id, end = values
    return Anchor(as_number(distance), as_text(clip_id), None if end is None else as_number(end))


def _refused(message: str) -> BadField:
    return BadField("The cursor cannot be used.", places=[Place("cursor", message)])
