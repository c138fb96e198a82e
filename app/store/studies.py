"""The study of low-dimensional motions: pairs that people compare, and their votes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from enum import StrEnum

from sqlalchemy import RowMapping, delete, func, insert, select

from app.errors import AlreadyVoted, NotFound
from app.store.clips import versions as library
from app.store.database.engine import Tx
from app.store.database.ids import new_id, utc_now
from app.store.database.paging import Page, Position, after, read_cursor, write_cursor
from app.store.database.tables import study_pairs, study_votes
from app.store.database.totals import Total, total_of

NEWEST_FIRST = "-created_at"

Keyposes = dict[str, list[int]]
"""Frames at 30 Hz by clip id."""


class Choice(StrEnum):
    """Which motion of a pair a voter finds closer to the original."""

    LEFT = "left"
    """The motion on the left."""
    RIGHT = "right"
    """The motion on the right."""
    SAME = "same"
    """Neither: the voter sees no difference."""


@dataclass(frozen=True, slots=True)
class PairRecord:
    """Two low-dimensional versions of a clip, side by side.

    keyposes: frames that both models are made from, by clip id; sequence: one text for all
    pairs of the same clip, model and dimensions; left_basis: the basis of the motion on the left.
    """

    id: str
    clip_id: str
    dimensions: int
    keyposes: Keyposes
    sequence: str
    left_basis: str
    created_at: datetime


@dataclass(frozen=True, slots=True)
class VoteCount:
    """The votes for a choice, in the pairs of a sequence that show `left_basis` on the left."""

    sequence: str
    clip_id: str
    dimensions: int
    left_basis: str
    choice: Choice
    votes: int


def add_pair(
    tx: Tx,
    clip_id: str,
    dimensions: int,
    keyposes: Mapping[str, list[int]],
    sequence: str,
    left_basis: str,
) -> PairRecord:
    """Stores a pair."""
    added = insert(study_pairs).values(
        id=new_id("pair"),
        clip_id=clip_id,
        dimensions=dimensions,
        keyposes=dict(keyposes),
        sequence=sequence,
        left_basis=left_basis,
        created_at=utc_now(),
    )
    return _to_pair(tx.execute(added.returning(study_pairs)).mappings().one())


def get_pair(tx: Tx, pair_id: str) -> PairRecord:
    """The pair; raises NotFound."""
    query = select(study_pairs).where(study_pairs.c.id == pair_id)
    row = tx.execute(query).mappings().one_or_none()
    if row is None:
        raise NotFound(f"There is no pair with the id {pair_id!r}")
    return _to_pair(row)


def list_pairs(tx: Tx, *, limit: int = 50, cursor: str | None = None) -> Page[PairRecord]:
    """One page of at most `limit` pairs, newest first; raises PageNotFound at "cursor"."""
    created, row_id = study_pairs.c.created_at, study_pairs.c.id
    query = select(study_pairs)
    if cursor is not None:
        position = read_cursor(cursor, NEWEST_FIRST, datetime)
        query = query.where(after(created, row_id, position, descending=True))
    # One row more than the page shows whether there is another page.
    query = query.order_by(created.desc(), row_id.desc()).limit(limit + 1)
    items = [_to_pair(row) for row in tx.execute(query).mappings()]
    shown = tuple(items[:limit])
    if len(items) <= limit:
        return Page(shown, None)
    return Page(shown, write_cursor(NEWEST_FIRST, Position(shown[-1].created_at, shown[-1].id)))


def total_pairs(tx: Tx) -> Total:
    """How many pairs there are; an estimate if there are many."""
    return total_of(tx, select(study_pairs.c.id))


def delete_pair(tx: Tx, pair_id: str) -> None:
    """Removes a pair and the votes on it; raises NotFound."""
    get_pair(tx, pair_id)
    tx.execute(delete(study_pairs).where(study_pairs.c.id == pair_id))


def add_vote(tx: Tx, pair: PairRecord, choice: Choice, voter_sha256: str | None) -> str:
    """Stores a vote and returns its id.

    Raises AlreadyVoted if this voter has voted on any pair of the same sequence.
    """
    if voter_sha256 is not None:
        library.lock(tx)  # so that no other process votes between this query and the insert
        earlier = select(study_votes.c.id).where(
            study_votes.c.sequence == pair.sequence, study_votes.c.voter_sha256 == voter_sha256
        )
        if tx.execute(earlier).first() is not None:
            raise AlreadyVoted
    vote_id = new_id("vote")
    tx.execute(
        insert(study_votes).values(
            id=vote_id,
            pair_id=pair.id,
            sequence=pair.sequence,
            choice=choice.value,
            voter_sha256=voter_sha256,
            created_at=utc_now(),
        )
    )
    return vote_id


def count_votes(tx: Tx, clip_id: str | None = None) -> tuple[VoteCount, ...]:
    """Counts of votes by sequence, left basis and choice, for one clip or for all clips."""
    by = (
        study_pairs.c.sequence,
        study_pairs.c.clip_id,
        study_pairs.c.dimensions,
        study_pairs.c.left_basis,
        study_votes.c.choice,
    )
    query = select(*by, func.count()).join(study_votes, study_votes.c.pair_id == study_pairs.c.id)
    if clip_id is not None:
        query = query.where(study_pairs.c.clip_id == clip_id)
    rows = tx.execute(query.group_by(*by).order_by(*by)).all()
    return tuple(
        VoteCount(sequence, clip, dimensions, left, Choice(choice), int(votes))
        for sequence, clip, dimensions, left, choice, votes in rows
    )


def _to_pair(row: RowMapping) -> PairRecord:
    return PairRecord(
        id=row["id"],
        clip_id=row["clip_id"],
        dimensions=row["dimensions"],
        keyposes=dict(row["keyposes"]),
        sequence=row["sequence"],
        left_basis=row["left_basis"],
        created_at=row["created_at"],
    )
