"""The library's labels: persons, tasks and words, with how many clips carry each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sqlalchemy import ColumnElement, FromClause, case, func, select

from app.store.engine import Tx
from app.store.tables import clip_words, clips


@dataclass(frozen=True, slots=True)
class Count:
    """A label, and how many clips carry it, whatever their state: those of one source, which
    are told apart, and all others."""

    name: str
    others: int
    of_source: int


def persons(tx: Tx, source: str) -> tuple[Count, ...]:
    """Who moves, by name; the clips of `source` are counted by themselves."""
    return _counts(tx, clips.c.person, clips, source)


def tasks(tx: Tx, source: str) -> tuple[Count, ...]:
    """What is done, as `persons`."""
    return _counts(tx, clips.c.task, clips, source)


def words(tx: Tx, source: str) -> tuple[Count, ...]:
    """In which words, as `persons`."""
    return _counts(tx, clip_words.c.word, clip_words.join(clips), source)


def person_names(tx: Tx) -> frozenset[str]:
    """Everybody whose label a clip carries."""
    found = select(clips.c.person).where(clips.c.person.is_not(None)).distinct()
    return frozenset(tx.execute(found).scalars())


def _counts(
    tx: Tx, name: ColumnElement[Any], carriers: FromClause, source: str
) -> tuple[Count, ...]:
    of_source = func.sum(case((clips.c.source == source, 1), else_=0))
    query = select(name, func.count(), of_source).select_from(carriers)
    rows = tx.execute(query.where(name.is_not(None)).group_by(name).order_by(name))
    return tuple(Count(label, int(every) - int(some), int(some)) for label, every, some in rows)
