"""Reads the arrays of NPY and NPZ files without trusting their headers.

Bytes in, arrays out, by NumPy's format specification (NEP 1, versions 1.0 to 3.0). The header is
matched against a strict pattern and never evaluated. No object is unpickled. Memory is allocated
only after the declared shape was compared with the limits and with the size of the content.
"""

from __future__ import annotations

import io
import re
import struct
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from math import prod
from typing import IO, Any

import numpy as np
from numpy.typing import NDArray

from app.errors import TooLarge
from app.formats.common.failures import too_large, unreadable_at
from app.kinedex_error import Place

MAX_ARRAY_BYTES = 480_000_000
"""The size of the largest array: 20 million joints times frames in float64."""
MAX_MEMBERS = 256
"""The most arrays in an NPZ file. Public ones have at most about 20."""
MAX_RATIO = 200
"""The largest ratio of unpacked to packed size. Movement is compressed to a tenth at best."""
SMALL_BYTES = 16_000_000
"""Arrays up to this size may have any ratio (for example, if all numbers are zero)."""
MAX_HEADER_BYTES = 4096
"""The longest header of an array."""
MAX_AXES = 8

_MAGIC = b"\x93NUMPY"
_HEADER = re.compile(
    r"\{\s*'descr':\s*'(?P<descr>[^']{1,16})',\s*'fortran_order':\s*(?P<fortran>True|False),"
    r"\s*'shape':\s*\((?P<shape>(?:\d{1,18}L?,\s?)*(?:\d{1,18}L?)?)\),?\s*\}\s*"
)
_DTYPE = re.compile(r"[<>|=]?(?:[fiuUSb]\d{1,4}|O)")
_ZIP_ENTRY = b"PK\x01\x02"
_ZIP_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
_ZIP_FAILURES = (
    zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, OverflowError,
    RuntimeError, ValueError, KeyError, IndexError,
)  # fmt: skip
"""Errors that the standard library raises for damaged archives. NotImplementedError is one of
RuntimeError."""


@dataclass(frozen=True, slots=True)
class _Header:
    """The header of an array: the type of its elements, its shape, and the order of its axes."""

    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    fortran: bool

    @property
    def nbytes(self) -> int:
        """Bytes of the array. Python's integers are used, because they do not overflow."""
        return prod(self.shape) * self.dtype.itemsize


def read_npy(content: bytes, key: str = "array") -> NDArray[Any]:
    """The array of an NPY file: numbers, booleans or text, of any shape and byte order.

    key: the name of the array in errors. Raises Unreadable, TooLarge.
    """
    return _read(io.BytesIO(content), key, MAX_ARRAY_BYTES)


class Archive:
    """The arrays of an NPZ file by key. Each is unpacked only when it is read."""

    def __init__(self, content: bytes) -> None:
        """Read only the directory of the archive. Raises Unreadable, TooLarge."""
        # Counted before zipfile builds an object for each entry.
        if content.count(_ZIP_ENTRY) > MAX_MEMBERS:
            raise too_large("archive", f"expected at most {MAX_MEMBERS} arrays")
        try:
            self._file = zipfile.ZipFile(io.BytesIO(content))
        except (*_ZIP_FAILURES, NotImplementedError) as problem:
            raise unreadable_at("archive", f"expected a ZIP archive, found {problem}") from problem
        self._members = {
            member.filename.removesuffix(".npy"): member
            for member in self._file.infolist()
            if member.filename.endswith(".npy")
        }

    def keys(self) -> tuple[str, ...]:
        """The names of the arrays."""
        return tuple(self._members)

    def kind(self, key: str) -> str:
        """The `dtype.kind` of an array; only its header is read. Raises Unreadable."""
        with self._opened(key) as stream:
            return _header(stream, key).dtype.kind

    def read(self, key: str) -> NDArray[Any]:
        """One array. Raises Unreadable, TooLarge."""
        packed = self._members[key].compress_size
        max_bytes = min(MAX_ARRAY_BYTES, max(SMALL_BYTES, MAX_RATIO * packed))
        with self._opened(key) as stream:
            return _read(stream, key, max_bytes)

    @contextmanager
    def _opened(self, key: str) -> Iterator[IO[bytes]]:
        method = self._members[key].compress_type
        if method not in _ZIP_METHODS:
            raise unreadable_at(key, f"expected deflate, found compression method {method}")
        try:
            with self._file.open(self._members[key]) as stream:
                yield stream
        except _ZIP_FAILURES as problem:
            raise unreadable_at(key, f"expected an intact array, found: {problem}") from problem


def _read(stream: IO[bytes], key: str, max_bytes: int) -> NDArray[Any]:
    header = _header(stream, key)
    if header.nbytes > max_bytes:
        shown = "x".join(map(str, header.shape))
        place = Place(key, f"expected at most {max_bytes} bytes, found {shown} {header.dtype}")
        raise TooLarge(f"The array {key} is too large.", places=[place])
    if not header.nbytes:
        raise unreadable_at(key, f"expected at least one element, found shape {header.shape}")
    # One byte more shows whether the content is longer than the header declares.
    content = stream.read(header.nbytes + 1)
    if len(content) != header.nbytes:
        there = "more" if len(content) > header.nbytes else str(len(content))
        raise unreadable_at(key, f"expected {header.nbytes} bytes as declared, found {there}")
    flat = np.frombuffer(content, header.dtype)
    if header.fortran:
        return flat.reshape(header.shape[::-1]).transpose()
    return flat.reshape(header.shape)


def _header(stream: IO[bytes], key: str) -> _Header:
    start = stream.read(8)
    if len(start) < 8 or not start.startswith(_MAGIC) or start[6] not in (1, 2, 3):
        raise unreadable_at(key, "expected an array in NPY format 1 to 3")
    wide = start[6] > 1
    length = int.from_bytes(stream.read(4 if wide else 2), "little")
    text = stream.read(min(length, MAX_HEADER_BYTES + 1))
    match = _HEADER.fullmatch(text.decode("latin-1"))
    if len(text) != length or match is None:
        raise unreadable_at(
            key, "expected a header with descr, fortran_order and shape of plain arrays"
        )
    sizes = re.findall(r"\d+", match["shape"])
    if len(sizes) > MAX_AXES:
        raise unreadable_at(key, f"expected at most {MAX_AXES} axes, found {len(sizes)}")
    shape = tuple(int(size) for size in sizes)
    return _Header(_dtype(match["descr"], key), shape, match["fortran"] == "True")


def _dtype(descr: str, key: str) -> np.dtype[Any]:
    if descr.endswith("O"):
        message = "expected numbers or text, found Python objects, which are never unpickled"
        raise unreadable_at(key, f"{message}; save it with a plain dtype (text as dtype=str)")
    try:
        if not _DTYPE.fullmatch(descr):
            raise TypeError(descr)
        return np.dtype(descr)
    except TypeError:
        raise unreadable_at(key, f"expected numbers or text, found dtype {descr!r}") from None


def numbers(array: NDArray[Any], key: str) -> NDArray[Any]:
    """The same array. Raises Unreadable if it does not contain integers or floats."""
    if array.dtype.kind not in "fiu":
        raise unreadable_at(key, f"expected numbers, found dtype {array.dtype}")
    return array


def texts(array: NDArray[Any], key: str) -> list[str]:
    """The strings of a one-dimensional array of text or bytes. Raises Unreadable."""
    if array.dtype.kind not in "US" or array.ndim > 1:
        shape = "x".join(map(str, array.shape))
        raise unreadable_at(key, f"expected a list of strings, found {shape} {array.dtype}")
    try:
        return list(_decoded(array.reshape(-1)))
    except ValueError as problem:  # for example, numbers that are not code points of Unicode
        raise unreadable_at(key, f"expected text, found {problem}") from None


def _decoded(array: NDArray[Any]) -> Iterator[str]:
    # numpy raises SystemError on code points beyond Unicode, so its text is decoded here
    big = array.dtype.str.startswith(">")
    wide = "utf-32-be" if big else "utf-32-le"
    encoding = wide if array.dtype.kind == "U" else "utf-8"
    content, size = array.tobytes(), array.dtype.itemsize
    for start in range(0, len(content), size):
        yield content[start : start + size].decode(encoding).rstrip("\0")
