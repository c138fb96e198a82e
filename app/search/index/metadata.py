"""The metadata of the clips in an index: for each key, the clips that have it and their values.

Most clips have few of the keys, so each key has its own short columns. Columns only grow: a search
reads the part that belongs to the clips of its view.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from app.numerics.arrays import BoolArray, IntArray
from app.search.index.column import Column
from app.store.clips.filter import MetadataCondition
from app.store.clips.index_feed import IndexedMetadata
from app.store.clips.metadata_values import MetadataValue, ValueKind, as_text, from_text, kind_of


class MetadataColumns:
    """The metadata of clips, by the clips' numbers."""

    def __init__(self) -> None:
        self._of_clip = Column(object)
        self._by_key: dict[str, _KeyColumn] = {}

    def extend(self, several: Iterable[IndexedMetadata]) -> None:
        """Add the metadata of clips; they get the next numbers."""
        first = len(self._of_clip)
        added = list(several)
        by_key: dict[str, list[tuple[int, MetadataValue]]] = {}
        column = np.empty(len(added), dtype=object)  # np.array would look into the tuples
        for index, metadata in enumerate(added):
            column[index] = metadata
            for key, value in metadata:
                by_key.setdefault(key, []).append((first + index, value))
        for key, values in by_key.items():
            self._by_key.setdefault(key, _KeyColumn()).extend(values)
        self._of_clip.extend(column)

    def at(self, number: int) -> IndexedMetadata:
        """The metadata of a clip."""
        metadata: IndexedMetadata = self._of_clip.view()[number]
        return metadata

    def coded(
        self, numbers: IntArray
    ) -> dict[str, tuple[IntArray, IntArray, tuple[MetadataValue, ...]]]:
        """For each key, what the clips `numbers` (n,) that have it have: their places in `numbers`
        (m,), ascending, the codes of their values (m,), and the values by code.

        Keys that none of the clips has are left out.
        """
        count = int(numbers.max(initial=-1)) + 1
        place_of = np.full(count, -1, dtype=np.int64)
        place_of[numbers] = np.arange(len(numbers))
        found: dict[str, tuple[IntArray, IntArray, tuple[MetadataValue, ...]]] = {}
        for key, column in tuple(self._by_key.items()):
            own, codes, values = column.coded(count)
            places = place_of[own]
            order = np.argsort(places, kind="stable")[int((places < 0).sum()) :]
            if len(order):
                found[key] = places[order], codes[order], values
        return found

    def mask(self, condition: MetadataCondition, count: int) -> BoolArray:
        """(count,) whether each of the first clips meets a condition."""
        mask = np.zeros(count, dtype=bool)
        column = self._by_key.get(condition.key)
        if column is not None:
            column.mark(condition, mask)
        return ~mask if condition.is_negated else mask


class _KeyColumn:
    """The clips with one key: their numbers, ascending, and the code of the value of each."""

    def __init__(self) -> None:
        self._numbers = Column(np.int32)
        self._codes = Column(np.int32)
        self._code_of: dict[tuple[ValueKind, str], int] = {}
        self._values: list[tuple[str, float | None]] = []

    def extend(self, values: Sequence[tuple[int, MetadataValue]]) -> None:
        """Add clips, each by its number and its value."""
        # in this order, so that a search that reads meanwhile finds a code for each number
        self._codes.extend([self._code(value) for _, value in values])
        self._numbers.extend([number for number, _ in values])

    def _code(self, value: MetadataValue) -> int:
        kind, text = kind_of(value), as_text(value)
        code = self._code_of.get((kind, text))
        if code is None:
            code = len(self._values)
            self._values.append((text, float(value) if kind is ValueKind.NUMBER else None))
            self._code_of[kind, text] = code
        return code

    def coded(self, count: int) -> tuple[IntArray, IntArray, tuple[MetadataValue, ...]]:
        """Of the first `count` clips, the numbers (m,) of those that have the key, the codes (m,)
        of their values, and the values by code."""
        values = tuple(from_text(kind, text) for kind, text in tuple(self._code_of))
        return (*self._first(count), values)

    def mark(self, condition: MetadataCondition, mask: BoolArray) -> None:
        """Set the entries of `mask` of the clips whose value passes."""
        numbers, codes = self._first(len(mask))
        passes = np.array([condition.accepts(*value) for value in tuple(self._values)])
        mask[numbers[passes[codes]]] = True

    def _first(self, count: int) -> tuple[IntArray, IntArray]:
        """Of the first `count` clips, the numbers of those that have the key, and their codes."""
        numbers = self._numbers.view()
        numbers = numbers[: np.searchsorted(numbers, count)]
        return numbers, self._codes.view()[: len(numbers)]
