"""The tree of a library's labels, kept in memory until the library changes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from threading import Lock

from app.models.words.language.label_tree import LabelTree, label_tree
from app.store import label_parents
from app.store.clips import labels
from app.store.clips import versions as library
from app.store.clips.labels import LabelKind
from app.store.database.engine import Tx


@dataclass(frozen=True, slots=True)
class LibraryTree:
    """The tree, the tasks and the words of the library, with the number of clips of each."""

    tree: LabelTree
    tasks: Mapping[str, int]
    words: Mapping[str, int]


class KeptTree:
    """The tree at one version of the library."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._kept: tuple[int, LibraryTree] | None = None

    def at(self, tx: Tx) -> LibraryTree:
        """The tree at the version that a transaction reads."""
        version = library.version(tx)
        with self._lock:
            if self._kept is not None and self._kept[0] == version:
                return self._kept[1]
        found = _read(tx)
        with self._lock:
            self._kept = version, found
        return found


def _read(tx: Tx) -> LibraryTree:
    tasks, words = (labels.counts(tx, kind) for kind in (LabelKind.TASK, LabelKind.WORD))
    tree = label_tree([*tasks, *words], label_parents.read(tx))
    return LibraryTree(tree, tasks, words)
