"""The tree of a library's labels: read it, and say which label is a kind of which."""

from __future__ import annotations

from collections.abc import Mapping

from app.models.words.language.label_tree import closes_circle
from app.models.words.language.normalize import normalize_word
from app.services import fields
from app.services.fields import bad_field
from app.services.library.kept_tree import LibraryTree
from app.services.library.library import Library
from app.store import audit, label_parents

MAX_PARENTS = 5_000
"""Labels for which people say the parent."""


def get_tree(lib: Library) -> LibraryTree:
    """The tree of the labels of a library."""
    with lib.store.read() as tx:
        return lib.tree.at(tx)


def put_parents(lib: Library, parents: Mapping[str, str | None]) -> LibraryTree:
    """Replace what people say about the tree. None: the label has no parent.

    Raises BadField for too many labels, an empty one, or a circle.
    """
    if len(parents) > MAX_PARENTS:
        raise bad_field("parents", f"must not be more than {MAX_PARENTS}")
    tidy = {
        _label(label): None if parent is None else _label(parent)
        for label, parent in parents.items()
    }
    circle = closes_circle(tidy)
    if circle is not None:
        raise bad_field(f"parents.{circle}", "would be a kind of itself")
    with lib.store.write() as tx:
        audit.note(labels=len(tidy))
        label_parents.replace(tx, tidy)
    return get_tree(lib)


def _label(text: str) -> str:
    tidy = normalize_word(fields.text("parents", text) or "")
    if not tidy:
        raise bad_field("parents", "a label must not be empty")
    return tidy
