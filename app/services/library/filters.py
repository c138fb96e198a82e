"""Filters of clients, with what only the library knows: kinds of labels, and clips of collections.

A task or a word of a filter means all kinds of it in the tree of labels. After an equals sign it
means itself alone: `kick` finds a "right leg kick", and `=kick` does not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import Any

from app.errors import BadField
from app.kinedex_error import Place
from app.search.index.filters import TREE_KEYS, as_filter
from app.services.library.kept_tree import LibraryTree
from app.services.library.library import Library
from app.store import collections
from app.store.clips.filter import ClipFilter, annotated_ids
from app.store.database.engine import Tx

EXACTLY = "="
"""Before a task or a word: no kinds of it."""
_KINDS = {
    "task": "tasks",
    "not_task": "tasks",
    "word": "words",
    "not_word": "words",
    "annotation": "words",
}
"""The labels of the library among which each condition looks for kinds."""


def resolved_filter(lib: Library, given: ClipFilter | Mapping[str, Any] | None) -> ClipFilter:
    """A filter that searches in memory and lists can use.

    Raises BadField for a filter that cannot be used, and for the id of no collection.
    """
    asked = as_filter(given)
    if not _needs_library(asked):
        return asked
    with lib.store.read() as tx:
        tree = lib.tree.at(tx) if _any(asked, _has_kinds) else None
        return _resolved(tx, tree, asked)


def _resolved(tx: Tx, tree: LibraryTree | None, asked: ClipFilter) -> ClipFilter:
    """A filter and the filters below it."""
    below: dict[str, Any] = {
        name: tuple(_resolved(tx, tree, one) for one in getattr(asked, name)) for name in TREE_KEYS
    }
    asked = replace(asked, **below)
    if tree is not None and _has_kinds(asked):
        asked = _with_kinds(tree, asked)
    if asked.annotation:
        asked = replace(asked, annotated=annotated_ids(tx, asked.annotation))
    return _with_members(tx, asked) if asked.collection else asked


def _has_kinds(asked: ClipFilter) -> bool:
    return any(getattr(asked, name) for name in _KINDS)


def _needs_library(asked: ClipFilter) -> bool:
    return _any(asked, lambda one: _has_kinds(one) or bool(one.collection))


def _any(asked: ClipFilter, holds: Callable[[ClipFilter], bool]) -> bool:
    """Whether something holds of a filter or of one below it."""
    below = (one for name in TREE_KEYS for one in getattr(asked, name))
    return holds(asked) or any(_any(one, holds) for one in below)


def _with_kinds(tree: LibraryTree, asked: ClipFilter) -> ClipFilter:
    changes: dict[str, Any] = {
        name: _kinds(tree, getattr(asked, name), labels)
        for name, labels in _KINDS.items()
        if getattr(asked, name)
    }
    return replace(asked, **changes)


def _kinds(tree: LibraryTree, values: Iterable[str], labels: str) -> tuple[str, ...]:
    found: list[str] = []
    for value in values:
        if value.startswith(EXACTLY):
            found.append(value.removeprefix(EXACTLY))
        else:
            found += [value, *tree.kinds_of(value, labels)]
    return tuple(dict.fromkeys(found))


def _with_members(tx: Tx, asked: ClipFilter) -> ClipFilter:
    unknown = sorted(set(asked.collection) - collections.existing(tx, asked.collection))
    if unknown:
        message = f"is the id of no collection: {', '.join(unknown)}"
        raise BadField("The filter cannot be used.", places=[Place("filter.collection", message)])
    return replace(asked, members=collections.clip_ids(tx, asked.collection))
