"""Arrays as bytes: little-endian, C order, with dtype and shape beside them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypedDict

import numpy as np
from numpy.typing import NDArray

KINDS = "biuf"
"""Booleans, integers and floats: nothing that would need pickle."""


class Blob(TypedDict):
    """The columns that hold an array: dtype as numpy writes it (`<f4`), shape, bytes."""

    dtype: str
    shape: list[int]
    data: bytes


def to_blob(array: NDArray[Any]) -> Blob:
    """Any array of booleans, integers or floats; raises ValueError for others."""
    if array.dtype.kind not in KINDS:
        raise ValueError(f"arrays of dtype {array.dtype} are not stored")
    little = array.astype(array.dtype.newbyteorder("<"), copy=False)
    return Blob(dtype=little.dtype.str, shape=list(array.shape), data=little.tobytes(order="C"))


def from_blob(dtype: str, shape: Sequence[int], data: bytes) -> NDArray[Any]:
    """The array, read-only, without a copy of its bytes."""
    return np.frombuffer(data, dtype=np.dtype(dtype)).reshape(tuple(shape))
