"""What people changed in the tree of labels: the parent of a label, or that it has none."""

from __future__ import annotations

from collections.abc import Collection, Mapping

from sqlalchemy import delete, insert, select

from app.store.clips import versions as library
from app.store.database.collection_tables import label_parents
from app.store.database.engine import Tx


def read(tx: Tx) -> dict[str, str | None]:
    """The parents by label, sorted by label."""
    query = select(label_parents.c.label, label_parents.c.parent).order_by(label_parents.c.label)
    return {row.label: row.parent for row in tx.execute(query).all()}


def replace(tx: Tx, parents: Mapping[str, str | None]) -> None:
    """Stores these parents instead of all earlier ones."""
    library.bump(tx)  # so that whoever keeps the tree reads it again
    tx.execute(delete(label_parents))
    rows = [{"label": label, "parent": parent} for label, parent in parents.items()]
    if rows:
        tx.execute(insert(label_parents), rows)


def remove(tx: Tx, labels: Collection[str]) -> None:
    """Removes what people said about these labels, as children and as parents."""
    known = read(tx)
    kept = {
        label: parent
        for label, parent in known.items()
        if label not in labels and parent not in labels
    }
    if kept != known:
        replace(tx, kept)
