"""Filters of clients, with what only the library knows: kinds of labels, and clips of collections.

A task or a word of a filter means all kinds of it in the tree of labels. After an equals sign it
means itself alone: `kick` finds a "right leg kick", and `=kick` does not.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

from app.errors import BadField
from app.kinedex_error import Place
from app.search.index.filters import as_filter
from app.services.library.kept_tree import LibraryTree
from app.services.library.library import Library
from app.store import collections
from app.store.clips.filter import ClipFilter
from app.store.database.engine import Tx

EXACTLY = "="
"""Before a task or a word: no kinds of it."""
_KINDS = {"task": "tasks", "not_task": "tasks", "word": "words", "not_word": "words"}
"""The labels of the library among which each condition looks for kinds."""


def resolved_filter(lib: Library, given: ClipFilter | Mapping[str, Any] | None) -> ClipFilter:
    """A filter that searches in memory and lists can use.

    Raises BadField for a filter that cannot be used, and for the id of no collection.
    """
    asked = as_filter(given)
    has_kinds = any(getattr(asked, name) for name in _KINDS)
    if not has_kinds and not asked.collection:
        return asked
    with lib.store.read() as tx:
        if has_kinds:
            asked = _with_kinds(lib.tree.at(tx), asked)
        return _with_members(tx, asked) if asked.collection else asked


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
