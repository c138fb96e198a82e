"""Arrays are read as numpy wrote them, or refused before memory is allocated."""

from __future__ import annotations

import tracemalloc
import zipfile

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from app.errors import TooLarge, Unreadable
from app.formats.npz.arrays import MAX_MEMBERS, Archive, numbers, read_npy, texts
from app.kinedex_error import KinedexError
from tests.cpu_time import cpu_seconds_below
from tests.formats.npz.files import lying_npy, npy, npz, zipped


@settings(max_examples=100, deadline=None)
@given(
    hnp.arrays(
        dtype=st.one_of(
            hnp.floating_dtypes(), hnp.integer_dtypes(), hnp.unsigned_integer_dtypes(),
            hnp.boolean_dtypes(),
        ),
        shape=hnp.array_shapes(min_dims=0, max_dims=4),
    ),
    st.booleans(),
)  # fmt: skip
def test_arrays_are_read_as_numpy_wrote_them(array: np.ndarray, fortran: bool) -> None:
    written = np.asfortranarray(array) if fortran else array
    for content in (npy(written), zipped({"array.npy": npy(written)})):
        found = read_npy(content) if content[:2] != b"PK" else Archive(content).read("array")
        np.testing.assert_array_equal(found, array)
        assert found.dtype == array.dtype


def test_text_is_read_as_unicode_and_as_bytes() -> None:
    assert texts(read_npy(npy(np.array(["Hüfte", "b"]))), "names") == ["Hüfte", "b"]
    assert texts(read_npy(npy(np.array([b"a", "é".encode()]))), "names") == ["a", "é"]
    assert texts(read_npy(npy(np.str_("m"))), "unit") == ["m"]


LIES = {
    "shape beyond memory": lying_npy("'<f8'", "(1000000000, 1000000)"),
    "product beyond 64 bits": lying_npy("'<f4'", "(4294967296, 4294967296, 3)"),
    "one digit too many": lying_npy("'<f4'", "(99999999999999999999,)"),
    "sizes without commas": lying_npy("'<f4'", "(3 18, 3)"),
    "many axes": lying_npy("'<f4'", "(1,1,1,1,1,1,1,1,1,1,6)"),
    "less data": lying_npy("'<f4'", "(3, 3)"),
    "more data": lying_npy("'<f4'", "(1, 3)"),
    "nothing": lying_npy("'<f4'", "(0, 24, 3)", b""),
    "objects": npy(np.array([{}, None], dtype=object), allow_pickle=True),
    "records": npy(np.zeros(2, dtype=[("a", "f4"), ("b", "i4")])),
    "complex": npy(np.zeros(2, dtype=complex)),
    "dates": npy(np.zeros(2, dtype="M8[s]")),
    "raw bytes": npy(np.zeros(2, dtype="V8")),
    "a dtype that is none": lying_npy("'<f3'", "(2,)"),
    "text of no length": lying_npy("'<U0'", "(1000000000000,)", b""),
    "code in the header": lying_npy("__import__('os')", "(1,)"),
    "a deep header": lying_npy("(" * 3000, "(1,)"),
    "a negative size": lying_npy("'<f4'", "(-1, 3)"),
    "a header that is cut": b"\x93NUMPY\x01\x00\xff\xff{'descr'",
    "version 9": b"\x93NUMPY\x09\x00\x00\x00",
    "no header": b"\x93NUMPY",
    "not this at all": b"x" * 100,
}


@pytest.mark.parametrize("lie", LIES)
def test_a_wrong_declaration_is_refused_by_name_without_cost(lie: str) -> None:
    for read in (
        lambda: read_npy(LIES[lie], "poses"),
        lambda: Archive(zipped({"poses.npy": LIES[lie]})).read("poses"),
    ):
        tracemalloc.start()
        with pytest.raises((Unreadable, TooLarge)) as refused:
            read()
        assert tracemalloc.get_traced_memory()[1] < 2_000_000
        tracemalloc.stop()
        assert refused.value.places[0].location == "poses"


def test_objects_are_refused_with_advice() -> None:
    with pytest.raises(Unreadable, match=r"never unpickled.*dtype=str"):
        read_npy(LIES["objects"])


def test_decompression_bombs_are_refused_before_they_are_unpacked() -> None:
    bomb = npz(compressed=True, positions=np.zeros((200_000, 50, 3), dtype=np.float32))
    assert len(bomb) < 200_000
    tracemalloc.start()
    with pytest.raises(TooLarge):
        Archive(bomb).read("positions")
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def test_a_member_larger_than_declared_is_refused() -> None:
    content = zipped({"a.npy": lying_npy("'<f4'", "(2, 3)", b"\0" * 50_000_000)})
    tracemalloc.start()
    with pytest.raises(Unreadable, match="expected 24 bytes"):
        Archive(content).read("a")
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def test_archives_of_too_many_arrays_are_refused_quickly() -> None:
    content = zipped({f"{i}.npy": b"" for i in range(MAX_MEMBERS + 1)})
    with cpu_seconds_below(0.5), pytest.raises(TooLarge):
        Archive(content)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_other_compression_methods_are_refused(method: int) -> None:
    with pytest.raises(Unreadable, match="deflate"):
        Archive(zipped({"a.npy": npy(np.zeros(3))}, method)).read("a")


def test_every_truncated_file_is_refused() -> None:
    content = npz(a=np.arange(5.0))
    for length in range(len(content)):
        with pytest.raises(Unreadable):
            Archive(content[:length])


def test_wrong_types_of_elements_are_refused() -> None:
    with pytest.raises(Unreadable):
        numbers(np.array(["a"]), "key")
    for array in (np.zeros(3), np.array([["a"]]), np.array([b"\xff"])):
        with pytest.raises(Unreadable):
            texts(array, "key")
    beyond_unicode = np.frombuffer(b"\xff\xff\xff\x7f", dtype="<U1")
    with pytest.raises(Unreadable):
        texts(beyond_unicode, "key")


@settings(max_examples=150, deadline=2000)
@given(st.data())
def test_damaged_archives_raise_only_our_own_errors(data: st.DataObject) -> None:
    content = bytearray(npz(compressed=data.draw(st.booleans()), a=np.arange(6.0), b="text"))
    for _ in range(data.draw(st.integers(1, 4))):
        start = data.draw(st.integers(0, len(content)))
        content[start : start + data.draw(st.integers(0, 8))] = data.draw(st.binary(max_size=6))
    try:
        archive = Archive(bytes(content))
    except KinedexError:
        return
    for key in archive.keys():  # noqa: SIM118 - no mapping
        try:
            archive.kind(key)
            archive.read(key)
        except KinedexError:
            continue
