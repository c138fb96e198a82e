"""Arrays are read with the dtype, shape and values that were stored, and read-only."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from numpy.typing import NDArray

from app.errors import NotFound
from app.store.clips import arrays
from app.store.database.blobs import from_blob, to_blob
from app.store.store import Store
from tests.store.conftest import AddClip
from tests.store.stored_arrays import array_versions

DTYPES = st.sampled_from(["<f4", "<f8", ">f4", ">i8", "u1", "?", "<i4"])


@settings(deadline=None)
@given(
    hnp.arrays(
        DTYPES.map(np.dtype), hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4)
    )
)
def test_a_blob_keeps_dtype_shape_and_values(array: NDArray[Any]) -> None:
    for layout in (array, np.asfortranarray(array)):
        blob = to_blob(layout)
        back = from_blob(**blob)
        assert blob["dtype"][0] in "<|"
        assert back.shape == layout.shape
        np.testing.assert_array_equal(back, layout)
        assert not back.flags.writeable


@pytest.mark.parametrize("array", [np.array([None]), np.array(["x"]), np.array([1j])])
def test_arrays_that_are_not_numbers_are_refused(array: NDArray[Any]) -> None:
    with pytest.raises(ValueError, match="not stored"):
        to_blob(array)


def test_arrays_of_a_clip_replace_the_earlier_ones(store: Store, add_clip: AddClip) -> None:
    clip = add_clip("walk")
    with store.write() as tx:
        arrays.put_many(tx, clip.id, {"a": np.zeros(2), "b": np.zeros(3)}, version=1)
        arrays.put_many(tx, clip.id, {"a": np.ones((2, 2), np.float32)}, version=2)
    with store.read() as tx:
        assert array_versions(tx, clip.id) == {"a": 2}
        found = arrays.get_one(tx, clip.id, "a")
        assert found.dtype == np.float32
        np.testing.assert_array_equal(found, np.ones((2, 2)))
        with pytest.raises(NotFound, match="'b'"):
            arrays.get_one(tx, clip.id, "b")


def test_some_arrays_of_a_clip_come_in_the_requested_order(store: Store, add_clip: AddClip) -> None:
    clip = add_clip("walk")
    with store.write() as tx:
        arrays.put_many(tx, clip.id, {n: np.full(2, n, "f4") for n in "123"}, version=1)
    with store.read() as tx:
        found = arrays.get_named(tx, clip.id, ("3", "1"))
        assert [(name, array.tolist()) for name, array in found.items()] == [
            ("3", [3.0, 3.0]),
            ("1", [1.0, 1.0]),
        ]
        with pytest.raises(NotFound, match="'4'"):
            arrays.get_named(tx, clip.id, ("1", "4"))


def test_one_array_of_many_clips(store: Store, add_clip: AddClip) -> None:
    ids = [add_clip(f"clip {number}").id for number in range(5)]
    with store.write() as tx:
        for number, clip_id in enumerate(ids[:4]):
            arrays.put_many(
                tx, clip_id, {"v": np.full(3, number), "w": np.zeros(1)}, version=1 + number % 2
            )
        found = arrays.get_many(tx, ids[::-1], "v")
        assert list(found) == ids[3::-1]
        assert [int(found[clip_id][0]) for clip_id in ids[:4]] == [0, 1, 2, 3]
        assert list(arrays.get_many(tx, ids, "v", version=2)) == [ids[1], ids[3]]
