"""The names in use in a library, with how many clips carry each."""

from __future__ import annotations

from app.services.library import Library
from app.store import labels as stored

Counts = list[tuple[str, int]]


def persons(lib: Library) -> Counts:
    """(person, clips), by name."""
    with lib.store.read() as tx:
        return list(stored.persons(tx))


def tasks(lib: Library) -> Counts:
    """(task, clips), by name."""
    with lib.store.read() as tx:
        return list(stored.tasks(tx))


def words(lib: Library) -> Counts:
    """(word, clips), by word."""
    with lib.store.read() as tx:
        return list(stored.words(tx))
