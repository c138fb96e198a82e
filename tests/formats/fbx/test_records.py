"""The records of FBX files: declared sizes are checked before they are used."""

from __future__ import annotations

import struct
import tracemalloc
import zlib

import pytest

from app.errors import TooLarge, Unreadable
from app.formats.fbx import records as fbx_records
from app.formats.fbx.reader import read_fbx
from app.formats.fbx.records import MAX_ARRAY_BYTES, FbxFile
from app.kinedex_error import KinedexError
from tests.cpu_time import cpu_seconds_below
from tests.formats.fbx.files import Array, Record, document
from tests.formats.fbx.test_reader import clip


@pytest.mark.parametrize("version", [7400, 7500])
def test_a_record_and_its_parts(version: int) -> None:
    inner = Record("Inner", [b"text", 7, 2.5])
    file = FbxFile(document([Record("Outer", [1], [inner, inner]), Record("Next")], version))
    outer, following = file.records()
    assert (outer.name, following.name) == ("Outer", "Next")
    assert outer.properties() == [1]
    assert [child.properties() for child in outer.children("Inner")] == [[b"text", 7, 2.5]] * 2
    assert outer.child("Absent") is None
    assert file.top("Next") is not None


@pytest.mark.parametrize("deflate", [False, True])
def test_arrays(deflate: bool) -> None:
    file = FbxFile(document([Record("A", [Array("l", [1, -2, 3], deflate)])]))
    (record,) = file.records()
    assert record.array().tolist() == [1, -2, 3]


def test_every_truncated_file_is_refused() -> None:
    content = clip()
    for length in range(30, len(content) - 20, 37):
        with pytest.raises(KinedexError):
            read_fbx(content[:length])


def test_the_error_has_the_byte() -> None:
    content = clip()
    with pytest.raises(Unreadable) as caught:
        read_fbx(content[: len(content) // 2])
    (place,) = caught.value.places
    assert place.location.startswith("byte ")


def bomb(count: int, stored: bytes) -> bytes:
    """A clip with `stored` as the bytes of an array of times, and `count` as its declared size."""
    content = clip(deflate=True)
    start = content.index(b"KeyTimel") + len(b"KeyTimel")
    length = struct.unpack_from("<I", content, start + 8)[0]
    assert len(stored) <= length
    head = struct.pack("<III", count, 1, length)
    return content[:start] + head + stored.ljust(length, b"\0") + content[start + 12 + length :]


@pytest.mark.parametrize("count", [7, 1_000, 2**31, 2**32 - 1])
def test_arrays_with_a_wrong_declared_size(count: int) -> None:
    tracemalloc.start()
    with pytest.raises((Unreadable, TooLarge)):
        read_fbx(bomb(count, b""))
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def test_a_decompression_bomb_is_not_decompressed() -> None:
    count = 2 * MAX_ARRAY_BYTES // 8
    zeros = zlib.compressobj(9)
    stored = b"".join(zeros.compress(bytes(1_000_000)) for _ in range(count * 8 // 1_000_000))
    stored += zeros.flush()
    array = Array("l", [], stored=stored, count=count)
    (record,) = FbxFile(document([Record("A", [array])])).records()
    tracemalloc.start()
    with pytest.raises(TooLarge):
        record.array()
    assert tracemalloc.get_traced_memory()[1] < 5_000_000
    tracemalloc.stop()


def test_all_arrays_share_one_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    content = clip(deflate=True)
    monkeypatch.setattr(fbx_records, "MAX_ARRAY_BYTES", 500)
    monkeypatch.setattr(fbx_records, "MAX_INFLATED_RATIO", 0)
    with pytest.raises(TooLarge, match="byte"):
        read_fbx(content)


def test_thousands_of_records_and_levels_are_harmless() -> None:
    deep = Record("Deep")
    for _ in range(100):
        deep = Record("Deep", [], [deep])
    other = Record("Video", [], [Record("N")] * 50_000)
    content = document([deep, other])
    with cpu_seconds_below(3.0):
        file = FbxFile(content)
        assert [record.name for record in file.records()] == ["Deep", "Video"]
        assert file.top("Objects") is None
