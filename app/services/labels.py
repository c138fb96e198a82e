"""The names in use in a library, with how many clips carry each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from app.services.library import Library
from app.services.synthesized import SYNTHESIZED
from app.store import labels as stored
from app.store.engine import Tx


@dataclass(frozen=True, slots=True)
class LabelCount:
    """A label; recordings: how many clips of what people did carry it; synthesized: how many of
    what we made. Their states do not matter."""

    name: str
    recordings: int
    synthesized: int


def persons(lib: Library) -> list[LabelCount]:
    """Who moves, by name."""
    return _counted(lib, stored.persons)


def tasks(lib: Library) -> list[LabelCount]:
    """What is done, by name."""
    return _counted(lib, stored.tasks)


def words(lib: Library) -> list[LabelCount]:
    """In which words, by word."""
    return _counted(lib, stored.words)


def _counted(
    lib: Library, count: Callable[[Tx, str], tuple[stored.Count, ...]]
) -> list[LabelCount]:
    with lib.store.read() as tx:
        found = count(tx, SYNTHESIZED)
    return [LabelCount(one.name, one.others, one.of_source) for one in found]
