"""The library's labels: persons, tasks and words, with how many clips carry each."""

from __future__ import annotations

from typing import Any

from sqlalchemy import ColumnElement, Select, func, select

from app.store.engine import Tx
from app.store.tables import clip_words, clips

Counts = tuple[tuple[str, int], ...]
"""Names in alphabetical order, each with its number of clips, whatever their state."""


def persons(tx: Tx) -> Counts:
    """Who moves."""
    return _counts(tx, select(clips.c.person, func.count()), clips.c.person)


def tasks(tx: Tx) -> Counts:
    """What is done."""
    return _counts(tx, select(clips.c.task, func.count()), clips.c.task)


def words(tx: Tx) -> Counts:
    """In which words."""
    return _counts(tx, select(clip_words.c.word, func.count()), clip_words.c.word)


def _counts(tx: Tx, query: Select[Any], name: ColumnElement[Any]) -> Counts:
    rows = tx.execute(query.where(name.is_not(None)).group_by(name).order_by(name))
    return tuple((label, int(count)) for label, count in rows)
