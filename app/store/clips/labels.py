"""The library's labels: persons, tasks and words, with how many clips carry each."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import ColumnElement, FromClause, case, func, select

from app.store.database.engine import Tx
from app.store.database.paging import Page, Position, read_cursor, write_cursor
from app.store.database.tables import clip_words, clips
from app.store.database.totals import Total, exact_total


@dataclass(frozen=True, slots=True)
class Count:
    """A label, and how many clips carry it, in any state.

    of_source: clips of the source that the caller names; others: all other clips.
    """

    name: str
    others: int
    of_source: int


class LabelKind(StrEnum):
    """What a label says."""

    PERSON = "person"
    """Who moves."""
    TASK = "task"
    """What is done."""
    WORD = "word"
    """A word for it."""


_KINDS: dict[LabelKind, tuple[ColumnElement[Any], FromClause]] = {
    LabelKind.PERSON: (clips.c.person, clips),
    LabelKind.TASK: (clips.c.task, clips),
    LabelKind.WORD: (clip_words.c.word, clip_words.join(clips)),
}


def persons(tx: Tx, source: str) -> tuple[Count, ...]:
    """The persons, by name; the clips of `source` are counted separately."""
    return _counts(tx, *_KINDS[LabelKind.PERSON], source)


def tasks(tx: Tx, source: str) -> tuple[Count, ...]:
    """The tasks, as `persons`."""
    return _counts(tx, *_KINDS[LabelKind.TASK], source)


def words(tx: Tx, source: str) -> tuple[Count, ...]:
    """The words, as `persons`."""
    return _counts(tx, *_KINDS[LabelKind.WORD], source)


def person_names(tx: Tx) -> frozenset[str]:
    """The persons that any clip is labeled with."""
    found = select(clips.c.person).where(clips.c.person.is_not(None)).distinct()
    return frozenset(tx.execute(found).scalars())


def page(
    tx: Tx, kind: LabelKind, source: str, limit: int, cursor: str | None = None
) -> Page[Count]:
    """At most `limit` labels of a kind, by name; raises BadField at "cursor"."""
    name, carriers = _KINDS[kind]
    after = None if cursor is None else read_cursor(cursor, kind.value, str).value
    found = _counts(tx, name, carriers, source, after=after, limit=limit + 1)
    if len(found) <= limit:
        return Page(found, None)
    shown = found[:limit]
    return Page(shown, write_cursor(kind.value, Position(shown[-1].name, "")))


def total(tx: Tx, kind: LabelKind) -> Total:
    """How many labels of a kind there are."""
    name, carriers = _KINDS[kind]
    query = select(name).select_from(carriers).where(name.is_not(None)).distinct()
    return exact_total(tx, query)


def _counts(
    tx: Tx,
    name: ColumnElement[Any],
    carriers: FromClause,
    source: str,
    *,
    after: Any = None,
    limit: int | None = None,
) -> tuple[Count, ...]:
    of_source = func.sum(case((clips.c.source == source, 1), else_=0))
    query = select(name, func.count(), of_source).select_from(carriers)
    query = query.where(name.is_not(None) if after is None else name > after)
    rows = tx.execute(query.group_by(name).order_by(name).limit(limit))
    return tuple(Count(label, int(every) - int(some), int(some)) for label, every, some in rows)
