"""The size that a WAV file declares."""

from __future__ import annotations

import struct

import pytest

from app.formats.audio.riff import declared_bytes


def _file(*chunks: tuple[bytes, bytes], magic: bytes = b"RIFF", order: str = "<") -> bytes:
    body = b"".join(
        name + struct.pack(f"{order}I", len(content)) + content + b"\0" * (len(content) % 2)
        for name, content in chunks
    )
    return magic + struct.pack(f"{order}I", 4 + len(body)) + b"WAVE" + body


@pytest.mark.parametrize(("magic", "order"), [(b"RIFF", "<"), (b"RIFX", ">")])
def test_the_declared_size_ends_with_the_samples(magic: bytes, order: str) -> None:
    chunks = ((b"fmt ", b"f" * 16), (b"LIST", b"odd"), (b"data", b"s" * 1000))
    whole = _file(*chunks, magic=magic, order=order)
    for length in (len(whole), len(whole) - 1, len(whole) - 1000):
        assert declared_bytes(whole[:length]) == len(whole)
    assert declared_bytes(whole + b"more behind it") == len(whole)


def test_files_without_a_known_size() -> None:
    whole = _file((b"fmt ", b"f" * 16), (b"data", b""))
    for content in (b"", b"fLaC", b"RIFF", whole, whole[:-4], whole[:20]):
        assert declared_bytes(content) is None
    assert declared_bytes(_file(*[(b"junk", b"")] * 1000, (b"data", b"s"))) is None


def test_a_file_of_more_than_four_gigabytes() -> None:
    size = 5 * 2**30
    ds64 = struct.pack("<QQQI", 0, size, 0, 0)
    head = _file((b"ds64", ds64), (b"fmt ", b"f" * 16), magic=b"RF64")
    head += b"data" + b"\xff" * 4
    assert declared_bytes(head) == len(head) + size
