"""The tree of a library's labels, kept in memory until the library changes."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from threading import Lock

from app.models.words.language.label_tree import LabelTree, label_tree
from app.models.words.language.normalize import normalize_word
from app.store import label_parents
from app.store.clips import labels
from app.store.clips import versions as library
from app.store.clips.labels import LabelKind
from app.store.database.engine import Tx


@dataclass(frozen=True, slots=True)
class LibraryTree:
    """The tree, the tasks and the words of the library, with the number of clips of each.

    kinds: by "tasks" and "words": for each node, the labels that are kinds of it.
    """

    tree: LabelTree
    tasks: Mapping[str, int]
    words: Mapping[str, int]
    kinds: Mapping[str, Mapping[str, tuple[str, ...]]]

    def kinds_of(self, label: str, labels: str) -> tuple[str, ...]:
        """The tasks or words (`labels`) that are a label or kinds of it, as `LabelTree.kinds`."""
        return self.kinds[labels].get(normalize_word(label), ())


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
    kinds = {"tasks": _by_node(tree, tasks), "words": _by_node(tree, words)}
    return LibraryTree(tree, tasks, words, kinds)


def _by_node(tree: LabelTree, own: Iterable[str]) -> dict[str, tuple[str, ...]]:
    """For each node, the labels that are it or below it: so a filter needs one look-up."""
    found: dict[str, list[str]] = {}
    for label in own:
        for node in tree.path(label):
            found.setdefault(node, []).append(label)
    return {node: tuple(below) for node, below in found.items()}
