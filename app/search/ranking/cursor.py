"""Opaque cursors that page through a ranking.

A cursor contains a digest of the query, and the rank, distance and clip id of the last hit of a
page. The next page begins after that hit. So clips that are added between two pages do not shift
the other hits. A cursor of another query is refused. If a shortlist was ranked again, the cursor
also contains the end of the shortlist. If distances are relative to typical ones of the library,
it contains these too.
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass

from app.errors import PageNotFound
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
    the whole shortlist is measured. guest: the distance and the id of the last clip that another
    view added to the shortlist, before it was ranked again; None without such a view.
    """

    distance: float
    clip_id: str
    end: float | None
    guest: tuple[float, str] | None = None


@dataclass(frozen=True, slots=True)
class Position:
    """The last hit of a page: its rank (from 1), distance and clip id; anchor: see `Anchor`.

    scales: typical distances, above 0, that the first page took from the library.
    """

    rank: int
    distance: float
    clip_id: str
    anchor: Anchor | None = None
    scales: tuple[float, ...] = ()


def digest(*parts: object) -> str:
    """A short digest of the parts that identify a query. Equal parts have the same digest."""
    text = json.dumps([str(part) for part in parts])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def encode(position: Position, query: str) -> str:
    """The cursor for the page after `position`; query: the digest of the query."""
    values: list[str | float | list[float] | None] = [
        query, position.rank, position.distance, position.clip_id
    ]  # fmt: skip
    if (anchor := position.anchor) is not None:
        values += [anchor.distance, anchor.clip_id, anchor.end, *(anchor.guest or ())]
    if position.scales:
        values.append(list(position.scales))
    return cursor_codec.encode(values)


def decode(cursor: str, query: str) -> Position:
    """The position in a cursor; query: the digest of the query.

    Raises PageNotFound if `cursor` is not a cursor, or the cursor of another query.
    """
    try:
        own_query, rank, distance, clip_id, *rest = cursor_codec.decode(cursor)
        last = rest[-1] if rest else None
        scales: tuple[float, ...] = ()
        if isinstance(last, list):
            scales, rest = _scales(last), rest[:-1]
        anchor = _anchor(rest) if rest else None
        position = Position(
            as_count(rank, MAX_RANK), as_number(distance), as_text(clip_id), anchor, scales
        )
    except ValueError as problem:
        raise _refused("this is not a cursor of this server") from problem
    if own_query != query:
        raise _refused("this cursor belongs to another query")
    return position


def _anchor(values: list[object]) -> Anchor:
    distance, clip_id, end, *guest = values
    last = None if end is None else as_number(end)
    return Anchor(as_number(distance), as_text(clip_id), last, _guest(guest) if guest else None)


def _guest(values: list[object]) -> tuple[float, str]:
    distance, clip_id = values
    return as_number(distance), as_text(clip_id)


def _scales(values: list[object]) -> tuple[float, ...]:
    scales = tuple(as_number(value) for value in values)
    if not all(scale > 0.0 for scale in scales):
        raise cursor_codec.NotACursor("a scale is not above 0")
    return scales


def _refused(message: str) -> PageNotFound:
    return PageNotFound(places=[Place("cursor", message)])
