"""The names in use in a library, with how many clips carry each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.services.library.library import Library
from app.services.library.synthesized import SYNTHESIZED
from app.store.clips import labels as stored
from app.store.clips.labels import LabelKind
from app.store.database.engine import Tx
from app.store.database.paging import Page


@dataclass(frozen=True, slots=True)
class LabelCount:
    """A label, and how many clips carry it, in any state.

    recordings: clips of what people did; synthesized: clips that Kinedex made.
    """

    name: str
    recordings: int
    synthesized: int


def persons(lib: Library) -> list[LabelCount]:
    """The persons, by name."""
    return _counted(lib, stored.persons)


def tasks(lib: Library) -> list[LabelCount]:
    """The tasks, by name."""
    return _counted(lib, stored.tasks)


def words(lib: Library) -> list[LabelCount]:
    """The words, in alphabetical order."""
    return _counted(lib, stored.words)


def page(lib: Library, kind: LabelKind, limit: int, cursor: str | None = None) -> Page[LabelCount]:
    """One page of the labels of a kind, by name. Raises PageNotFound for a bad cursor."""
    with lib.store.read() as tx:
        found = stored.page(tx, kind, SYNTHESIZED, limit, cursor)
        total = stored.total(tx, kind)
    return Page(tuple(map(_label_count, found.items)), found.next).counted(total)


def _counted(
    lib: Library, count: Callable[[Tx, str], tuple[stored.CountBySource, ...]]
) -> list[LabelCount]:
    with lib.store.read() as tx:
        found = count(tx, SYNTHESIZED)
    return list(map(_label_count, found))


def _label_count(one: stored.CountBySource) -> LabelCount:
    return LabelCount(one.name, one.others, one.of_source)
