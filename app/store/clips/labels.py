"""The labels of a library (persons, tasks and words) with the number of clips of each."""

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
class CountBySource:
    """A label and the number of clips that have it, in any state.

    of_source: clips from the source that the caller names; others: all other clips.
    """

    name: str
    others: int
    of_source: int


class LabelKind(StrEnum):
    """The kinds of labels that are counted."""

    PERSON = "person"
    """The person who moves."""
    TASK = "task"
    """The action in the clip."""
    WORD = "word"
    """A word that describes the clip."""
    SOURCE = "source"
    """Where the clip comes from."""
    LICENSE = "license"
    """The license of the clip."""


_KINDS: dict[LabelKind, tuple[ColumnElement[Any], FromClause]] = {
    LabelKind.PERSON: (clips.c.person, clips),
    LabelKind.TASK: (clips.c.task, clips),
    LabelKind.WORD: (clip_words.c.word, clip_words.join(clips)),
    LabelKind.SOURCE: (clips.c.source, clips),
    LabelKind.LICENSE: (clips.c.license, clips),
}


def persons(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The persons, sorted by name; the clips of `source` are counted separately."""
    return _counts(tx, *_KINDS[LabelKind.PERSON], source)


def tasks(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The tasks, as `persons`."""
    return _counts(tx, *_KINDS[LabelKind.TASK], source)


def words(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The words, as `persons`."""
    return _counts(tx, *_KINDS[LabelKind.WORD], source)


def person_names(tx: Tx) -> frozenset[str]:
    """The names of all persons in the labels of clips."""
    query = select(clips.c.person).where(clips.c.person.is_not(None)).distinct()
    return frozenset(tx.execute(query).scalars())


def page(
    tx: Tx, kind: LabelKind, source: str, limit: int, cursor: str | None = None
) -> Page[CountBySource]:
    """At most `limit` labels of a kind, sorted by name; raises BadField at "cursor"."""
    name, carriers = _KINDS[kind]
    after = None if cursor is None else read_cursor(cursor, kind.value, str).value
    counts = _counts(tx, name, carriers, source, after=after, limit=limit + 1)
    if len(counts) <= limit:
        return Page(counts, None)
    shown = counts[:limit]
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
) -> tuple[CountBySource, ...]:
    of_source = func.sum(case((clips.c.source == source, 1), else_=0))
    query = select(name, func.count(), of_source).select_from(carriers)
    query = query.where(name.is_not(None) if after is None else name > after)
    rows = tx.execute(query.group_by(name).order_by(name).limit(limit))
    return tuple(
        CountBySource(label, int(every) - int(some), int(some)) for label, every, some in rows
    )
