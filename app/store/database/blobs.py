"""Arrays as bytes: little-endian and C order, with dtype and shape in other columns."""

from __future__ import annotations

from functools import lru_cache
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

KINDS = "biuf"
"""Kinds of dtype that are stored: booleans, integers and floats, which need no pickle."""


class Blob(TypedDict):
    """The columns that hold an array.

    dtype: as numpy writes it, `<f4`; shape: as `300x13x3`, empty for a scalar.
    """

    dtype: str
    shape: str
    data: bytes


def to_blob(array: NDArray[Any]) -> Blob:
    """An array of booleans, integers or floats as columns; raises ValueError for other arrays."""
    if array.dtype.kind not in KINDS:
        raise ValueError(f"arrays of dtype {array.dtype} are not stored")
    little = array.astype(array.dtype.newbyteorder("<"), copy=False)
    shape = "x".join(str(length) for length in array.shape)
    return Blob(dtype=little.dtype.str, shape=shape, data=little.tobytes(order="C"))


def from_blob(dtype: str, shape: str, data: bytes) -> NDArray[Any]:
    """The array, read-only, without a copy of its bytes.

    Raises TypeError, ValueError if dtype, shape and number of bytes do not fit together.
    """
    return np.frombuffer(data, dtype=np.dtype(dtype)).reshape(_lengths(shape))


def from_blob_if_whole(dtype: str, shape: str, data: bytes) -> NDArray[Any] | None:
    """As `from_blob`, but None for a damaged array: one clip must not stop the search of all."""
    try:
        return from_blob(dtype, shape, data)
    except (TypeError, ValueError):
        return None


@lru_cache(maxsize=1024)
def _lengths(shape: str) -> tuple[int, ...]:
    # Cached, because an index reads many arrays of the same shape.
    return tuple(int(length) for length in shape.split("x") if length)
