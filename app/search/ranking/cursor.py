"""Opaque cursors that page through a ranking.

A cursor remembers the last hit of a page as (rank, distance, clip id) and a digest of the
question. The next page starts behind that key, so that clips that arrive in between
shift nothing; a cursor used with another question is refused. Where only a shortlist was
ranked again, it also remembers where that ended.
"""

from __future__ import annotations

import base64
import hashlib
import json
import math
from dataclasses import dataclass

from app.errors import BadField, Place

LARGEST_RANK = 10**9


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
    """A short digest of what identifies a question: the same parts, the same digest."""
    text = json.dumps([str(part) for part in parts])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def encode(position: Position, question: str) -> str:
    """A cursor for what follows `position` in the answer to `question` (a digest)."""
    anchor = position.anchor
    told = [] if anchor is None else [anchor.distance, anchor.clip_id, anchor.end]
    body = json.dumps([question, position.rank, position.distance, position.clip_id, *told])
    return base64.urlsafe_b64encode(body.encode()).decode().rstrip("=")


def decode(cursor: str, question: str) -> Position:
    """The position in a cursor; raises BadField where it is none, or of another question."""
    try:
        padded = cursor.encode("ascii") + b"=" * (-len(cursor) % 4)
        found, rank, distance, clip_id, *told = json.loads(base64.urlsafe_b64decode(padded))
        anchor = _anchor(*told) if told else None
        position = Position(_rank(rank), _distance(distance), _text(clip_id), anchor)
    except (ValueError, TypeError, OverflowError, RecursionError) as problem:
        raise _refused("this is no cursor that was given out") from problem
    if found != question:
        raise _refused("this cursor belongs to another question")
    return position


def _anchor(distance: object, clip_id: object, end: object) -> Anchor:
    return Anchor(_distance(distance), _text(clip_id), None if end is None else _distance(end))


def _rank(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value <= LARGEST_RANK:
        raise ValueError("rank")
    return value


def _distance(value: object) -> float:
    if not isinstance(value, float | int) or isinstance(value, bool) or not math.isfinite(value):
        raise ValueError("distance")
    return float(value)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError("clip id")
    value.encode()  # Half of a surrogate pair is valid JSON, but no text.
    return value


def _refused(message: str) -> BadField:
    return BadField("The cursor cannot be used.", places=[Place("cursor", message)])
