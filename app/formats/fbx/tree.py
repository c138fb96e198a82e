"""The records of an FBX file, whatever its form: binary, text, or built from an older version."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from app.numerics.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class ArrayProperty:
    """The position of an array: `count` numbers of `dtype` in `length` bytes from `offset` on."""

    dtype: str
    count: int
    deflated: bool
    offset: int
    length: int


Property = bool | int | float | bytes | ArrayProperty


class Record(Protocol):
    """A record: its name, its offset in the file, its properties and its children."""

    @property
    def name(self) -> str:
        """The name of the record."""

    @property
    def offset(self) -> int:
        """The byte at which the record begins."""

    @property
    def property_count(self) -> int:
        """The number of properties."""

    def children(self, name: str | None = None) -> Iterator[Record]:
        """The children; only those with a name if one is given."""

    def child(self, name: str) -> Record | None:
        """The first child of this name."""

    def properties(self, limit: int = 16) -> list[Property]:
        """The first `limit` properties. Text is given as bytes."""

    def array(self) -> FloatArray | IntArray:
        """(n,) the numbers of an array; empty without any."""


class RecordFile(Protocol):
    """A file of records. version: for example 7400."""

    @property
    def version(self) -> int:
        """The version of FBX, for example 7400."""

    def top(self, name: str) -> Record | None:
        """The first record of this name at the top level."""


@dataclass(frozen=True, slots=True)
class BuiltRecord:
    """A record in memory. numbers: those of `array`."""

    name: str
    offset: int = 0
    values: Sequence[Property] = ()
    below: Sequence[Record] = ()
    numbers: FloatArray | IntArray = field(default_factory=lambda: np.zeros(0))

    @property
    def property_count(self) -> int:
        """The number of properties."""
        return len(self.values)

    def children(self, name: str | None = None) -> Iterator[Record]:
        """The children; only those with a name if one is given."""
        return (child for child in self.below if name is None or child.name == name)

    def child(self, name: str) -> Record | None:
        """The first child of this name."""
        return next(self.children(name), None)

    def properties(self, limit: int = 16) -> list[Property]:
        """The first `limit` properties."""
        return list(self.values[:limit])

    def array(self) -> FloatArray | IntArray:
        """(n,) the numbers."""
        return self.numbers
