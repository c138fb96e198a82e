"""An array that grows at its end."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import DTypeLike, NDArray

_FIRST_CAPACITY = 1024


class Column:
    """An array (n, *tail) that grows at its end; earlier views of it never change."""

    def __init__(self, dtype: DTypeLike, tail: tuple[int, ...] = ()) -> None:
        self._data = np.empty((_FIRST_CAPACITY, *tail), dtype=dtype)
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def extend(self, values: Sequence[Any] | NDArray[Any]) -> None:
        """Add entries (m, *tail)."""
        count = self._count + len(values)
        if count > len(self._data):
            # twice the size, so that n entries are copied O(n) times in all
            capacity = max(count, 2 * len(self._data))
            grown = np.empty((capacity, *self._data.shape[1:]), self._data.dtype)
            grown[: self._count] = self.view()
            self._data = grown
        self._data[self._count : count] = values
        self._count = count

    def view(self) -> NDArray[Any]:
        """All entries so far, (n, *tail)."""
        return self._data[: self._count]

    def copy(self) -> Column:
        """A copy. Its entries may be changed, because it has no views yet."""
        copy = Column(self._data.dtype, self._data.shape[1:])
        copy.extend(self.view())
        return copy
