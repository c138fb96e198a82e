"""The size that a WAV file declares. Decoders do not report that a file was cut off."""

from __future__ import annotations

import struct

_FIRST_CHUNK = 12
_CHUNK_HEAD = 8
_MIN_UNKNOWN_SIZE = 0x7FFF0000
"""Programs write sizes from here on if they do not know the size yet."""
_MAX_CHUNKS = 100
"""The most chunks before the samples. If a file has more, its size counts as unknown."""


def declared_bytes(content: bytes) -> int | None:
    """The size in bytes of a complete RIFF, RIFX or RF64 WAV file, by the header of its samples.

    None if the content is not a WAV file, was written as a stream, or has no samples.
    """
    if content[:4] not in (b"RIFF", b"RIFX", b"RF64"):
        return None
    order = ">" if content[:4] == b"RIFX" else "<"
    at, long_size = _FIRST_CHUNK, None
    for _ in range(_MAX_CHUNKS):
        name, head = content[at : at + 4], content[at + 4 : at + _CHUNK_HEAD]
        if len(head) < 4:
            return None
        (size,) = struct.unpack(f"{order}I", head)
        at += _CHUNK_HEAD
        if name == b"ds64" and len(content) >= at + 16:
            (long_size,) = struct.unpack_from(f"{order}Q", content, at + 8)
        if name == b"data":
            length = long_size if long_size is not None else size
            is_known = long_size is not None or length < _MIN_UNKNOWN_SIZE
            return at + length if is_known and length else None
        # Chunks have an even size; one more byte follows an odd one.
        at += size + size % 2
    return None
