"""Builds glTF files for tests of the reader, with arrays of every kind."""

from __future__ import annotations

import base64
import json
import struct
from typing import Any

from numpy.typing import NDArray

_TYPES = {"f4": 5126, "i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125}
_KINDS = {1: "SCALAR", 3: "VEC3", 4: "VEC4", 16: "MAT4"}


class Document:
    """A glTF file with nodes and animations, to which arrays are added."""

    def __init__(self, nodes: list[dict[str, Any]]) -> None:
        self.blob = b""
        self.json: dict[str, Any] = {
            "asset": {"version": "2.0"}, "nodes": nodes, "scenes": [{"nodes": [0]}],
            "accessors": [], "bufferViews": [], "animations": [],
        }  # fmt: skip

    def view(self, content: bytes, stride: int = 0) -> int:
        entry = {"buffer": 0, "byteOffset": len(self.blob), "byteLength": len(content)}
        self.json["bufferViews"].append(entry | ({"byteStride": stride} if stride else {}))
        self.blob += content + b"\0" * (-len(content) % 4)
        return len(self.json["bufferViews"]) - 1

    def array(self, numbers: NDArray[Any], *, normalized: bool = False, gap: int = 0) -> int:
        """The index of a new accessor; gap: bytes between two elements."""
        width = numbers.shape[1]
        rows = [row.tobytes() + b"\7" * gap for row in numbers]
        stride = numbers.itemsize * width + gap if gap else 0
        entry: dict[str, Any] = {
            "bufferView": self.view(b"".join(rows), stride),
            "componentType": _TYPES[numbers.dtype.str[1:]],
            "count": len(numbers),
            "type": _KINDS[width],
        }
        self.json["accessors"].append(entry | ({"normalized": True} if normalized else {}))
        return len(self.json["accessors"]) - 1

    def animate(
        self,
        channels: list[tuple[int, str, int, int]],
        name: str = "walk",
        interpolation: str = "LINEAR",
    ) -> None:
        """Add an animation. channels: node, path, and the accessors of times and of values."""
        samplers = [
            {"input": times, "output": values, "interpolation": interpolation}
            for _, _, times, values in channels
        ]
        targets = [
            {"sampler": index, "target": {"node": node, "path": path}}
            for index, (node, path, _, _) in enumerate(channels)
        ]
        self.json["animations"].append({"name": name, "samplers": samplers, "channels": targets})

    def glb(self) -> bytes:
        text = json.dumps(self.json | {"buffers": [{"byteLength": len(self.blob)}]}).encode()
        text += b" " * (-len(text) % 4)
        total = 28 + len(text) + len(self.blob)
        head = struct.pack("<4sIII4s", b"glTF", 2, total, len(text), b"JSON")
        return head + text + struct.pack("<I4s", len(self.blob), b"BIN\0") + self.blob

    def gltf(self, uri: str | None = None) -> bytes:
        """The file in JSON; uri: of the buffer, by default the numbers themselves."""
        data = "data:application/octet-stream;base64," + base64.b64encode(self.blob).decode()
        buffer = {"byteLength": len(self.blob), "uri": uri or data}
        return json.dumps(self.json | {"buffers": [buffer]}).encode()
