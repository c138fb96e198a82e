"""The labels of a library (persons, tasks and words) with the number of clips of each."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

from sqlalchemy import Column, func, select

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


_COLUMNS: dict[LabelKind, Column[Any]] = {
    LabelKind.PERSON: clips.c.person,
    LabelKind.TASK: clips.c.task,
    LabelKind.WORD: clip_words.c.word,
    LabelKind.SOURCE: clips.c.source,
    LabelKind.LICENSE: clips.c.license,
}


def persons(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The persons, sorted by name; the clips of `source` are counted separately."""
    return _counts(tx, _COLUMNS[LabelKind.PERSON], source)


def tasks(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The tasks, as `persons`."""
    return _counts(tx, _COLUMNS[LabelKind.TASK], source)


def words(tx: Tx, source: str) -> tuple[CountBySource, ...]:
    """The words, as `persons`."""
    return _counts(tx, _COLUMNS[LabelKind.WORD], source)


def counts(tx: Tx, kind: LabelKind) -> dict[str, int]:
    """The number of clips by label, of all labels of a kind."""
    name = _COLUMNS[kind]
    query = select(name, func.count()).where(name.is_not(None)).group_by(name).order_by(name)
    return {label: int(count) for label, count in tx.execute(query).all()}


def person_names(tx: Tx) -> frozenset[str]:
    """The names of all persons in the labels of clips."""
    query = select(clips.c.person).where(clips.c.person.is_not(None)).distinct()
    return frozenset(tx.execute(query).scalars())


def page(
    tx: Tx, kind: LabelKind, source: str, limit: int, cursor: str | None = None
) -> Page[CountBySource]:
    """At most `limit` labels of a kind, sorted by name; raises PageNotFound at "cursor"."""
    after = None if cursor is None else read_cursor(cursor, kind.value, str).value
    counts = _counts(tx, _COLUMNS[kind], source, after=after, limit=limit + 1)
    if len(counts) <= limit:
        return Page(counts, None)
    shown = counts[:limit]
    return Page(shown, write_cursor(kind.value, Position(shown[-1].name, "")))


def total(tx: Tx, kind: LabelKind) -> Total:
    """How many labels of a kind there are."""
    name = _COLUMNS[kind]
    query = select(name).where(name.is_not(None)).distinct()
    return exact_total(tx, query)


def _counts(
    tx: Tx,
    name: Column[Any],
    source: str,
    *,
    after: Any = None,
    limit: int | None = None,
) -> tuple[CountBySource, ...]:
    """The counts by label.

    Two queries, because each reads nothing but indexes. To look at the source of every clip takes
    ten times as long, for words thirty times (100,000 clips, SQLite).
    """
    wanted = name.is_not(None) if after is None else name > after
    every = select(name, func.count()).where(wanted)
    rows = tx.execute(every.group_by(name).order_by(name).limit(limit)).all()
    of_source = _of_source(tx, name, source)
    return tuple(
        CountBySource(label, int(count) - of_source.get(label, 0), of_source.get(label, 0))
        for label, count in rows
    )


def _of_source(tx: Tx, name: Column[Any], source: str) -> dict[str, int]:
    """The number of clips of a source by label."""
    both = clips if name.table is clips else clip_words.join(clips)
    query = select(name, func.count()).select_from(both).where(clips.c.source == source)
    return {label: int(count) for label, count in tx.execute(query.group_by(name)) if label}
