"""The columns of a manifest: labels, hints, and metadata, with a check of their names.

A column with the name of a field is that field, in upper or lower case. Any other column is a key
of the metadata. But a name that is almost the name of a field (`tsak`, `Frame Rate`) is an error:
otherwise a typing error would silently become metadata. `meta.tsak` is metadata in any case.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

from app.errors import BadField
from app.formats.csv.formulas import unguarded
from app.services import clip_fields
from app.store.clips.record import META

MIN_CHECKED_LENGTH = 4
"""Shorter names of fields, as `fps`, are like too many other words."""
MAX_LONG_ERRORS, LONG_NAME = 2, 8
"""Typing errors in a name of at least LONG_NAME characters that are still noticed; in a shorter
one, it is one error."""


class BadColumn(ValueError):
    """The name of a column cannot be used; the message says why."""


class Columns:
    """The positions of a manifest's columns. Each manifest has its own object.

    header: the cells of its first line; expected: names of the fields to look for, besides `path`
    and `audio`; names: those of them that the manifest has; keys: of the metadata.
    """

    def __init__(self, header: Sequence[str], expected: Collection[str]) -> None:
        """Sort the columns. Raises BadColumn."""
        known = {"path", "audio", *expected}
        self._index_of: dict[str, int] = {}
        self._key_indexes: dict[str, int] = {}
        for index, cell in enumerate(header):
            name = cell.strip()
            if name.lower() in known:
                self._add(self._index_of, name.lower(), index)
            elif name:
                self._add(self._key_indexes, metadata_key(name, known), index)
        self.names = tuple(name for name in expected if name in self._index_of)
        self._indexes = tuple(self._index_of[name] for name in self.names)
        self.keys = tuple(self._key_indexes)

    def __contains__(self, name: str) -> bool:
        return name in self._index_of

    def cell(self, cells: Sequence[str], name: str) -> str:
        """The row's cell in a column; empty if there is no such column or the row is shorter."""
        return _cell(cells, self._index_of.get(name, len(cells)))

    def named_cells(self, cells: Sequence[str]) -> tuple[str, ...]:
        """The row's cells in the columns `names`, in that order."""
        return tuple(_cell(cells, index) for index in self._indexes)

    def metadata_cells(self, cells: Sequence[str]) -> tuple[str, ...]:
        """The row's cells in the columns of `keys`, in that order."""
        return tuple(_cell(cells, index) for index in self._key_indexes.values())

    @staticmethod
    def _add(indexes: dict[str, int], name: str, index: int) -> None:
        if name in indexes:
            raise BadColumn(f"two columns are called `{name}`")
        indexes[name] = index


def _cell(cells: Sequence[str], index: int) -> str:
    return unguarded(cells[index].strip()) if index < len(cells) else ""


def metadata_key(name: str, known: Collection[str]) -> str:
    """The key of the metadata that a name stands for; it may begin with `meta.`.

    known: the names of fields that may be meant instead. Raises BadColumn.
    """
    if not name.startswith(META):
        near = nearest(name, known)
        if near is not None:
            raise BadColumn(
                f"`{name}` is not the name of a field; is `{near}` meant? If it is metadata of your"
                f" own, write `{META}{name}`"
            )
    try:
        return clip_fields.metadata_key(name.removeprefix(META))
    except BadField as problem:
        raise BadColumn(f"`{name}`: {problem.places[0].message}") from problem


def nearest(name: str, known: Collection[str]) -> str | None:
    """The known name that differs from a name by typing errors only; None if there is none."""
    tidy = "_".join(name.casefold().replace("-", " ").replace("_", " ").split())
    found = [
        (errors, other)
        for other in known
        if len(other) >= MIN_CHECKED_LENGTH
        and (errors := typing_errors(tidy, other))
        <= (MAX_LONG_ERRORS if len(other) >= LONG_NAME else 1)
    ]
    return min(found)[1] if found else None


def typing_errors(first: str, second: str) -> int:
    """The number of typing errors between two words.

    An error is a character too many, too few or wrong, or two that changed places (optimal string
    alignment; Damerau 1964). The standard library's difflib has no such number: its ratio is 0.75
    for `tsak` and `task`, but also for `take` and `task`, which are two errors apart.
    """
    before: list[int] = []
    row = list(range(len(second) + 1))
    for i, a in enumerate(first, 1):
        next_row = [i]
        for j, b in enumerate(second, 1):
            best = min(row[j] + 1, next_row[j - 1] + 1, row[j - 1] + (a != b))
            if i > 1 and j > 1 and a == second[j - 2] and first[i - 2] == b:
                best = min(best, before[j - 2] + 1)
            next_row.append(best)
        before, row = row, next_row
    return row[-1]
