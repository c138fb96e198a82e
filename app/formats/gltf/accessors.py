"""Reads the arrays of numbers of a glTF file.

Each number is a float, or an integer that stands for a fraction. An array may be sparse: some of
its elements are replaced. Source: Khronos, "glTF 2.0 specification", section 3.6.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from app.errors import FormatNotSupported, Unreadable
from app.formats.common.failures import too_large, unreadable_at
from app.formats.gltf.container import Container, Json
from app.kinedex_error import Place
from app.numerics.arrays import FloatArray

MAX_ELEMENTS = 20_000_000
"""The most elements of an array."""
_DTYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COMPONENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


class Accessors:
    """The arrays of a file. Each is read once."""

    def __init__(self, container: Container) -> None:
        self._container = container
        self._buffers: dict[object, bytes] = {}
        self._read: dict[object, FloatArray] = {}

    def array(self, index: object) -> FloatArray:
        """(elements, numbers of an element) float32. Raises Unreadable, TooLarge.

        Raises FormatNotSupported for compressed numbers.
        """
        entry = self._container.entry("accessors", index)
        if index not in self._read:
            numbers = self._elements(f"accessors/{index}", entry)
            self._read[index] = _as_floats(numbers, entry)
        return self._read[index]

    def _elements(self, location: str, entry: Json) -> NDArray[np.generic]:
        count = _whole(location, entry, "count", None)
        width = _COMPONENTS.get(str(entry.get("type")))
        if width is None:
            raise unreadable_at(location, f"expected a type, found {str(entry.get('type'))[:40]!r}")
        if count > MAX_ELEMENTS:
            raise too_large(location, f"expected at most {MAX_ELEMENTS} elements, found {count}")
        dtype = _dtype(location, entry)
        if "bufferView" in entry:
            numbers = self._in_view(location, entry, dtype, count, width)
        else:
            numbers = np.zeros((count, width), dtype)
        return self._with_sparse(location, entry, numbers)

    def _with_sparse(
        self, location: str, entry: Json, numbers: NDArray[np.generic]
    ) -> NDArray[np.generic]:
        sparse = entry.get("sparse")
        if sparse is None:
            return numbers
        where, what = (_object(location, sparse, name) for name in ("indices", "values"))
        count = _whole(location, sparse, "count", None)
        dtype = _dtype(location, where)
        places = self._in_view(location, where, dtype, count, 1)[:, 0].astype(np.int64)
        values = self._in_view(location, what, numbers.dtype, count, numbers.shape[1])
        if len(places) and not 0 <= places.min() <= places.max() < len(numbers):
            raise unreadable_at(location, "expected sparse indices within the array")
        replaced = numbers.copy()
        replaced[places] = values
        return replaced

    def _in_view(
        self, location: str, entry: Json, dtype: np.dtype[np.generic], count: int, width: int
    ) -> NDArray[np.generic]:
        """(count, width) the numbers in a view of a buffer, which may be apart by a stride."""
        view = self._container.entry("bufferViews", entry.get("bufferView"))
        if view.get("extensions"):
            raise _compressed(location, view)
        buffer = self._buffer(view.get("buffer"))
        start = _whole(location, view, "byteOffset", 0)
        length = _whole(location, view, "byteLength", None)
        offset = _whole(location, entry, "byteOffset", 0)
        size = dtype.itemsize * width
        stride = _whole(location, view, "byteStride", 0) or size
        needed = offset + (stride * (count - 1) + size if count else 0)
        if stride < size or needed > length or start + length > len(buffer):
            found = f"{min(length, max(0, len(buffer) - start))}"
            raise unreadable_at(location, f"expected {needed} bytes in its view, found {found}")
        if not count:
            return np.zeros((0, width), dtype)
        return np.ndarray((count, width), dtype, buffer, start + offset, (stride, dtype.itemsize))

    def _buffer(self, index: object) -> bytes:
        self._container.entry("buffers", index)
        if index not in self._buffers:
            self._buffers[index] = self._container.buffer(index)
        return self._buffers[index]


def _as_floats(numbers: NDArray[np.generic], entry: Json) -> FloatArray:
    """(elements, n) float32. Integers with `normalized` are fractions of their largest value."""
    floats = numbers.astype(np.float32)
    if entry.get("normalized") is True and numbers.dtype.kind in "iu":
        largest = float(np.iinfo(numbers.dtype.str).max)
        floats = np.maximum(floats / np.float32(largest), np.float32(-1))
    return floats


def _dtype(location: str, entry: Json) -> np.dtype[np.generic]:
    found = entry.get("componentType")
    if not isinstance(found, int) or found not in _DTYPES:
        raise unreadable_at(location, f"expected a component type, found {str(found)[:40]!r}")
    return np.dtype(_DTYPES[found])


def _whole(location: str, entry: Json, name: str, default: int | None) -> int:
    """A number that is whole and not negative."""
    found = entry.get(name, default)
    if type(found) is not int or not 0 <= found < 2**40:
        raise unreadable_at(
            location, f"expected a whole number as {name}, found {str(found)[:40]!r}"
        )
    return found


def _object(location: str, entry: object, name: str) -> Json:
    found = entry.get(name) if isinstance(entry, dict) else None
    if not isinstance(found, dict):
        raise unreadable_at(location, f"expected an object as {name}")
    return found


def _compressed(location: str, view: Json) -> FormatNotSupported | Unreadable:
    extensions = view["extensions"]
    names = ", ".join(extensions) if isinstance(extensions, dict) else "unknown"
    return FormatNotSupported(
        "The numbers of this glTF file are compressed. Save it without compression.",
        places=[Place(location, f"expected numbers, found the extension {names[:80]}")],
    )
