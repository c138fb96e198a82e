"""Opens GLB and glTF files: the JSON object, and the bytes of its buffers.

A GLB file is a header of 12 bytes and chunks, the first of which is JSON. Buffers are the second
chunk, or base64 text in the JSON object. Buffers in other files cannot be read. Source: Khronos,
"glTF 2.0 specification", sections 3.6.1 (buffers) and 4 (GLB).
"""

from __future__ import annotations

import base64
import binascii
import struct
from dataclasses import dataclass, field
from typing import Any

from app.errors import FormatNotSupported
from app.formats.common.failures import unreadable_at, unreadable_byte
from app.formats.common.json_text import parse_json
from app.formats.common.numbers import excerpt
from app.kinedex_error import Place

MAGIC = b"glTF"
_HEADER = struct.Struct("<4sII")
_CHUNK = struct.Struct("<I4s")
_BASE64 = ";base64,"

Json = dict[str, Any]


@dataclass(frozen=True, slots=True)
class Container:
    """document: the JSON object. binary: the second chunk of a GLB file, empty without one."""

    document: Json
    binary: bytes
    _checked: dict[str, list[Json]] = field(default_factory=dict)

    def entries(self, name: str) -> list[Json]:
        """The objects of an array at the top level; empty without it. Raises Unreadable."""
        if name not in self._checked:
            found = self.document.get(name, [])
            if not isinstance(found, list) or not all(isinstance(entry, dict) for entry in found):
                raise unreadable_at(name, "expected a list of objects")
            self._checked[name] = found
        return self._checked[name]

    def entry(self, name: str, index: object) -> Json:
        """The object with an index in an array at the top level. Raises Unreadable."""
        entries = self.entries(name)
        if not isinstance(index, int) or isinstance(index, bool) or not 0 <= index < len(entries):
            raise unreadable_at(
                name, f"expected an index below {len(entries)}, found {index!r:.40}"
            )
        return entries[index]

    def buffer(self, index: object) -> bytes:
        """The bytes of a buffer. Raises Unreadable, and FormatNotSupported for another file."""
        uri = self.entry("buffers", index).get("uri")
        if uri is None and index == 0:
            return self.binary
        if not isinstance(uri, str) or not uri.startswith("data:"):
            message = f"expected the numbers in this file, found {excerpt(str(uri).encode())}"
            raise FormatNotSupported(
                "The numbers of this glTF file are in another file. Save it as GLB.",
                places=[Place(f"buffers/{index}", message)],
            )
        try:
            return base64.b64decode(uri.partition(_BASE64)[2], validate=True)
        except (binascii.Error, ValueError):
            raise unreadable_at(f"buffers/{index}", "expected base64") from None


def open_gltf(content: bytes) -> Container:
    """Open a GLB file, or a glTF file in JSON. Raises Unreadable, FormatNotSupported, TooLarge."""
    if not content.startswith(MAGIC):
        return Container(_parsed(content), b"")
    if len(content) < _HEADER.size + _CHUNK.size:
        raise unreadable_byte(len(content), "expected the header of a GLB file, found the end")
    version = _HEADER.unpack_from(content)[1]
    if version != 2:
        raise FormatNotSupported(f"This is glTF {version}. Save it as glTF 2.0.")
    length, kind = _CHUNK.unpack_from(content, _HEADER.size)
    start = _HEADER.size + _CHUNK.size
    if kind != b"JSON" or start + length > len(content):
        raise unreadable_byte(_HEADER.size, f"expected a chunk of JSON in {len(content)} bytes")
    return Container(_parsed(content[start : start + length]), _binary(content, start + length))


def _binary(content: bytes, at: int) -> bytes:
    if at + _CHUNK.size > len(content):
        return b""
    length, kind = _CHUNK.unpack_from(content, at)
    start = at + _CHUNK.size
    if kind != b"BIN\0":
        return b""
    if start + length > len(content):
        raise unreadable_byte(at, f"expected {length} bytes, found {len(content) - start}")
    return content[start : start + length]


def _parsed(text: bytes) -> Json:
    document = parse_json(text)
    if not isinstance(document, dict):
        raise unreadable_at("JSON", "expected an object")
    return document
