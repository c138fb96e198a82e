"""Some columns of clips, for long lists that show no more of them.

To read a thousand whole clips takes about 40 ms, most of it for words and JSON columns. To read
a few plain columns of them takes about 3 ms.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from sqlalchemy import select

from app.store.clips import visibility
from app.store.clips.measures import MEASURES
from app.store.clips.repository import in_batches
from app.store.database.engine import Tx
from app.store.database.tables import clips

PLAIN = frozenset(
    {
        *("id", "name", "state", "format", "sha256", "person", "task", "license", "source"),
        *("frames", "declared_frame_rate", "created_at", *MEASURES),
    }
)
"""Fields of `ClipRecord` that are columns of the same name and need no conversion."""


class PartialClip:
    """A clip with some of the fields of `ClipRecord`. Other attributes raise AttributeError."""

    def __init__(self, values: Mapping[str, Any]) -> None:
        self._values = values

    def __getattr__(self, name: str) -> Any:
        try:
            return self._values[name]
        except KeyError:
            raise AttributeError(f"{name} was not read") from None


def read(tx: Tx, clip_ids: Collection[str], names: Collection[str]) -> dict[str, PartialClip]:
    """The clips that exist among `clip_ids`, by id, with the fields `names`, all of PLAIN."""
    columns = [clips.c[name] for name in sorted({"id", *names})]
    return {
        row["id"]: PartialClip(dict(row))
        for batch in in_batches(clip_ids)
        for row in tx.execute(
            visibility.of_visible(select(*columns).where(clips.c.id.in_(batch)))
        ).mappings()
    }
