"""Reads the records of a binary FBX file, each only when it is needed.

A record has a header (end, number of properties, their length, name), properties, and children. A
header of zeros ends a list of children. Offsets have 32 bits before version 7500, and then 64.
Children are only read on request, so that deep files need no recursion. Memory is allocated only
after a declared size was compared with the bytes of the file.

Source: "FBX binary file format specification" (Blender developers' blog, 2013), and files.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import too_large, unreadable_byte
from app.formats.common.numbers import excerpt
from app.formats.fbx.tree import ArrayProperty, Property
from app.numerics.arrays import FloatArray, IntArray

MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
MIN_WIDE_VERSION = 7500
"""From this version on, offsets have 64 bits."""
MAX_ARRAY_BYTES = 64_000_000
"""The largest decompressed size of an array. A curve with MAX_FRAMES keys is smaller."""
MAX_DEFLATE_RATIO = 1040
"""The largest ratio of decompressed to compressed size that deflate can reach."""
MAX_INFLATED_RATIO = 200
"""The largest ratio of the decompressed size of all arrays to the size of the file. The first
MAX_ARRAY_BYTES do not count."""

_HEADER_BYTES = len(MAGIC) + 4
_SCALARS = {
    "C": struct.Struct("<B"),
    "B": struct.Struct("<b"),
    "Y": struct.Struct("<h"),
    "I": struct.Struct("<i"),
    "F": struct.Struct("<f"),
    "D": struct.Struct("<d"),
    "L": struct.Struct("<q"),
}
_ARRAYS = {"f": "<f4", "d": "<f8", "i": "<i4", "l": "<i8", "b": "|u1", "c": "|u1"}


class FbxFile:
    """A binary FBX file. It counts the bytes that were decompressed."""

    def __init__(self, content: bytes) -> None:
        """Read the version. content: the magic, the version, and records."""
        self.content = content
        self.version = int.from_bytes(content[len(MAGIC) : _HEADER_BYTES], "little")
        wide = self.version >= MIN_WIDE_VERSION
        self.header = struct.Struct("<QQQB" if wide else "<IIIB")
        self._inflatable = MAX_ARRAY_BYTES + MAX_INFLATED_RATIO * len(content)

    def records(self) -> Iterator[FbxRecord]:
        """The records at the top level."""
        return self.records_between(_HEADER_BYTES, len(self.content))

    def top(self, name: str) -> FbxRecord | None:
        """The first record of this name at the top level."""
        return next((record for record in self.records() if record.name == name), None)

    def records_between(self, start: int, end: int) -> Iterator[FbxRecord]:
        """The records of a list of children. A record of zeros may end the list."""
        while start < end:
            record = self._record(start, end)
            if record is None:
                return
            yield record
            start = record.end

    def _record(self, offset: int, limit: int) -> FbxRecord | None:
        names_at = offset + self.header.size
        if names_at > limit:
            raise unreadable_byte(offset, "expected a record, found the end")
        end, count, length, name_length = self.header.unpack_from(self.content, offset)
        if end == 0:
            return None
        properties_at = names_at + name_length
        children_at = properties_at + length
        if not offset < children_at <= end <= limit:
            raise unreadable_byte(offset, f"expected a record within {limit} bytes, found {end}")
        name = self.content[names_at:properties_at].decode("ascii", errors="replace")
        return FbxRecord(self, name, offset, properties_at, count, children_at, end)

    def array(self, at: ArrayProperty) -> FloatArray | IntArray:
        """(count,) the numbers of an array. Raises Unreadable, TooLarge."""
        size = at.count * np.dtype(at.dtype).itemsize
        stored = self.content[at.offset : at.offset + at.length]
        if not at.deflated:
            if size != len(stored):
                raise unreadable_byte(at.offset, f"expected {size} bytes, found {len(stored)}")
            return np.frombuffer(stored, dtype=at.dtype)
        return np.frombuffer(self._inflated(at, stored, size), dtype=at.dtype)

    def _inflated(self, at: ArrayProperty, stored: bytes, size: int) -> bytes:
        if size > MAX_DEFLATE_RATIO * (len(stored) + 1):
            raise unreadable_byte(at.offset, f"expected {size} bytes in {len(stored)}")
        self._inflatable -= size
        if size > MAX_ARRAY_BYTES or self._inflatable < 0:
            raise too_large(f"byte {at.offset}", "expected smaller arrays")
        try:
            # One byte more shows whether the data is longer than the file declares.
            data = zlib.decompressobj().decompress(stored, size + 1)
        except zlib.error as error:
            raise unreadable_byte(at.offset, f"expected deflated numbers ({error})") from None
        if len(data) != size:
            raise unreadable_byte(at.offset, f"expected {size} inflated bytes")
        return data


@dataclass(frozen=True, slots=True)
class FbxRecord:
    """A record: its name, its offset in the file, and the offsets of its parts."""

    file: FbxFile
    name: str
    offset: int
    properties_at: int
    property_count: int
    children_at: int
    end: int

    def children(self, name: str | None = None) -> Iterator[FbxRecord]:
        """The children; only those with a name if one is given."""
        found = self.file.records_between(self.children_at, self.end)
        return (child for child in found if name is None or child.name == name)

    def child(self, name: str) -> FbxRecord | None:
        """The first child of this name."""
        return next(self.children(name), None)

    def properties(self, limit: int = 16) -> list[Property]:
        """The first `limit` properties. Text is given as bytes, an array as its position."""
        found: list[Property] = []
        offset = self.properties_at
        for _ in range(min(self.property_count, limit)):
            value, offset = self._property(offset)
            found.append(value)
        return found

    def array(self) -> FloatArray | IntArray:
        """(n,) the numbers of the first property, which must be an array; empty without any."""
        first = self.properties(1)
        if not first:
            return np.zeros(0)
        if not isinstance(first[0], ArrayProperty):
            raise unreadable_byte(self.offset, f"expected an array in {self.name}")
        return self.file.array(first[0])

    def _property(self, offset: int) -> tuple[Property, int]:
        code = chr(self._bytes(offset, 1)[0])
        if code in _SCALARS:
            scalar = _SCALARS[code]
            (value,) = scalar.unpack(self._bytes(offset + 1, scalar.size))
            return value, offset + 1 + scalar.size
        if code in "SR":
            length = int.from_bytes(self._bytes(offset + 1, 4), "little")
            return self._bytes(offset + 5, length), offset + 5 + length
        if code in _ARRAYS:
            return self._array_property(code, offset)
        raise unreadable_byte(
            offset, f"expected a type of property, found {excerpt(code.encode())}"
        )

    def _array_property(self, code: str, offset: int) -> tuple[Property, int]:
        count, encoding, length = struct.unpack("<III", self._bytes(offset + 1, 12))
        if encoding not in (0, 1):
            raise unreadable_byte(offset, f"expected encoding 0 or 1, found {encoding}")
        self._bytes(offset + 13, length)
        at = ArrayProperty(_ARRAYS[code], count, encoding == 1, offset + 13, length)
        return at, offset + 13 + length

    def _bytes(self, offset: int, length: int) -> bytes:
        if offset + length > self.children_at:
            raise unreadable_byte(offset, f"expected {length} bytes in {self.name}")
        return self.file.content[offset : offset + length]
