"""Finds the stored files that a clip or an open job still refers to."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from sqlalchemy import Column, ColumnElement, select, union

from app.store.clips import versions as library
from app.store.clips.repository import in_batches
from app.store.database import schema
from app.store.database.engine import Tx
from app.store.database.tables import clips, jobs
from app.store.jobs.record import OPEN_STATES

_OF_OPEN_JOBS = jobs.c.state.in_([state.value for state in OPEN_STATES])
_Reference = tuple[Column[Any], tuple[ColumnElement[bool], ...]]
_REFERENCES: tuple[_Reference, ...] = (
    (clips.c.sha256, ()),
    (clips.c.skeleton_sha256, ()),
    (clips.c.audio_sha256, ()),
    (jobs.c.file_sha256, (_OF_OPEN_JOBS,)),
)
"""Columns that name files, each with the condition on its rows."""


def unreferenced(tx: Tx, sha256s: Collection[str]) -> tuple[str, ...]:
    """The files among `sha256s` that no clip and no open job refers to, in the same order."""
    library.lock(tx)  # until the commit, so that no writer adds a reference after this query
    needed: set[str] = set()
    for batch in in_batches(sha256s):
        needed.update(_needed(tx, batch))
    return tuple(sha256 for sha256 in dict.fromkeys(sha256s) if sha256 not in needed)


def referenced(tx: Tx) -> frozenset[str]:
    """All files that a clip or an open job refers to."""
    return _all_of(tx, _REFERENCES)


def referenced_in_any_schema(tx: Tx) -> frozenset[str]:
    """As `referenced`, in a database that may have an older schema with fewer columns."""
    return _all_of(tx, [(c, when) for c, when in _REFERENCES if schema.has_column(tx, c)])


def _all_of(tx: Tx, references: Sequence[_Reference]) -> frozenset[str]:
    every = union(*(select(c).where(c.is_not(None), *when) for c, when in references))
    return frozenset(tx.execute(every).scalars())


def _needed(tx: Tx, batch: list[str]) -> set[str]:
    every = union(*(select(c).where(c.in_(batch), *when) for c, when in _REFERENCES))
    return set(tx.execute(every).scalars())
