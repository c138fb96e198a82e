"""Writes small binary FBX files for the tests of the reader."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

KTIME = 46_186_158_000
MAGIC = b"Kaydara FBX Binary  \x00\x1a\x00"
CONSTANT, NEXT, LINEAR, CUBIC = 0x2, 0x102, 0x4, 0x8
AUTO, TCB, USER = 0x108, 0x208, 0x408
CLAMP, TIMED, PROGRESSIVE = 0x1000, 0x2000, 0x4000
WEIGHTED_RIGHT, WEIGHTED_LEFT = 0x1000000, 0x2000000
Vector = tuple[float, float, float]


@dataclass(frozen=True)
class Curve:
    """The keys of a curve. times: seconds. flags, data: of all keys, or of each key.

    data: the right slope, the next left slope, the weights and the velocities.
    """

    times: Sequence[float]
    values: Sequence[float]
    flags: int | Sequence[int] = LINEAR
    data: Sequence[Sequence[float]] = ((0, 0, 0, 0),)
    extra: tuple[Record, ...] = ()


@dataclass(frozen=True)
class Bone:
    """A node. parent: an index, or -1. properties: by their names in FBX."""

    name: str
    parent: int = -1
    properties: Mapping[str, Any] = field(default_factory=dict)
    subtype: str = "LimbNode"


Curves = Mapping[tuple[int, str], Mapping[str, Curve]]
"""The curves by axis of each property, by the index of the node and the property's name."""


@dataclass(frozen=True)
class Take:
    """A stack with one layer for each mapping. span: seconds."""

    name: str
    layers: Sequence[Curves]
    span: tuple[float, float] | None = None
    layer_properties: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Array:
    """An array property: the letter of its type, and its numbers."""

    code: str
    numbers: Sequence[float]
    deflate: bool = False
    stored: bytes | None = None
    """Compressed bytes that are written in place of the numbers."""
    count: int = 0
    """The declared count of the numbers in `stored`."""


class Letter(str):
    """A letter in a list of keys of version 6."""


@dataclass(frozen=True)
class Record:
    name: str
    properties: Sequence[Any] = ()
    children: Sequence[Record] = ()


def fbx(
    bones: Sequence[Bone],
    takes: Sequence[Take] = (),
    *,
    version: int = 7400,
    settings: Mapping[str, Any] | None = None,
    template: Mapping[str, Any] | None = None,
    header: Sequence[Record] = (),
    deflate: bool = True,
) -> bytes:
    """The bytes of a binary file with a scene."""
    records = scene(
        bones, takes, settings=settings, template=template, header=header, deflate=deflate
    )
    return document(records, version)


def scene(
    bones: Sequence[Bone],
    takes: Sequence[Take] = (),
    *,
    settings: Mapping[str, Any] | None = None,
    template: Mapping[str, Any] | None = None,
    header: Sequence[Record] = (),
    deflate: bool = True,
) -> list[Record]:
    """The records of a scene of version 7."""
    objects, connections = _nodes(bones)
    for index, take in enumerate(takes):
        more, links = _take(take, 1_000_000 * (index + 1), deflate)
        objects += more
        connections += links
    definition = Record("PropertyTemplate", [b"FbxNode"], [properties70(template or {})])
    return [
        Record("FBXHeaderExtension", [], [Record("EncryptionType", [0]), *header]),
        Record("GlobalSettings", [], [properties70(settings or {})]),
        Record("Definitions", [], [Record("ObjectType", [b"Model"], [definition])]),
        Record("Objects", [], objects),
        Record("Connections", [], [Record("C", link) for link in connections]),
    ]


def document(records: Iterable[Record], version: int = 7400) -> bytes:
    """The bytes of a file: magic, version, records, and the empty record at the end."""
    start = MAGIC + version.to_bytes(4, "little")
    wide = version >= 7500
    content = start
    for record in records:
        content += _record(record, len(content), wide)
    return content + bytes(25 if wide else 13) + b"footer"


def properties70(values: Mapping[str, Any]) -> Record:
    lines = []
    for name, value in values.items():
        numbers = value if isinstance(value, tuple) else (value,)
        lines.append(Record("P", [name.encode(), b"", b"", b"A", *numbers]))
    return Record("Properties70", [], lines)


def bone_id(index: int) -> int:
    return 100 + index


def _nodes(bones: Sequence[Bone]) -> tuple[list[Record], list[list[Any]]]:
    objects, links = [], []
    for index, bone in enumerate(bones):
        name = bone.name.encode() + b"\x00\x01Model"
        head = [np.int64(bone_id(index)), name, bone.subtype.encode()]
        objects.append(Record("Model", head, [properties70(bone.properties)]))
        parent = 0 if bone.parent < 0 else bone_id(bone.parent)
        links.append([b"OO", np.int64(bone_id(index)), np.int64(parent)])
    return objects, links


def _take(take: Take, base: int, deflate: bool) -> tuple[list[Record], list[list[Any]]]:
    span = {}
    if take.span is not None:
        ticks = [np.int64(round(second * KTIME)) for second in take.span]
        span = {"LocalStart": ticks[0], "LocalStop": ticks[1]}
    objects = [_object("AnimationStack", base, take.name, [properties70(span)])]
    links: list[list[Any]] = []
    number = base
    for layer, curves in enumerate(take.layers):
        number += 1
        layer_id = number
        objects.append(
            _object("AnimationLayer", layer_id, f"{layer}", [properties70(take.layer_properties)])
        )
        links.append([b"OO", np.int64(layer_id), np.int64(base)])
        for (bone, name), by_axis in curves.items():
            number += 1
            node_id = number
            objects.append(_object("AnimationCurveNode", node_id, "T"))
            links.append([b"OO", np.int64(node_id), np.int64(layer_id)])
            links.append([b"OP", np.int64(node_id), np.int64(bone_id(bone)), name.encode()])
            for axis, curve in by_axis.items():
                number += 1
                objects.append(_curve(number, curve, deflate))
                links.append([b"OP", np.int64(number), np.int64(node_id), b"d|" + axis.encode()])
    return objects, links


def _object(kind: str, number: int, name: str, children: Sequence[Record] = ()) -> Record:
    return Record(
        kind, [np.int64(number), name.encode() + b"\x00\x01" + kind.encode(), b""], children
    )


def _curve(number: int, curve: Curve, deflate: bool) -> Record:
    count = len(curve.times)
    flags = [curve.flags] * count if isinstance(curve.flags, int) else list(curve.flags)
    data = list(curve.data) * (count if len(curve.data) == 1 else 1)
    shared = len(set(flags)) == 1 and len(curve.data) == 1
    flat = [number for row in (data[:1] if shared else data) for number in row]
    ticks = [round(second * KTIME) for second in curve.times]
    children = [
        Record("KeyTime", [Array("l", ticks, deflate)]),
        Record("KeyValueFloat", [Array("f", curve.values, deflate)]),
        Record("KeyAttrFlags", [Array("i", flags[:1] if shared else flags)]),
        Record("KeyAttrDataFloat", [Array("f", flat)]),
        Record("KeyAttrRefCount", [Array("i", [count] if shared else [1] * count)]),
        *curve.extra,
    ]
    return _object("AnimationCurve", number, "", children)


def packed_weights(right: float, left: float) -> float:
    """Two weights in the bits of a float."""
    bits = round(right * 10_000) | round(left * 10_000) << 16
    return float(np.array([bits], dtype=np.uint32).view(np.float32)[0])


def _record(record: Record, offset: int, wide: bool) -> bytes:
    header = struct.Struct("<QQQB" if wide else "<IIIB")
    name = record.name.encode()
    properties = b"".join(_property(value) for value in record.properties)
    content = name + properties
    start = offset + header.size
    if record.children:
        for child in record.children:
            content += _record(child, start + len(content), wide)
        content += bytes(header.size)
    end = start + len(content)
    return header.pack(end, len(record.properties), len(properties), len(name)) + content


def _property(value: Any) -> bytes:
    if isinstance(value, Array):
        return _array(value)
    if isinstance(value, Letter):
        return b"C" + value.encode()
    if isinstance(value, bytes):
        return b"S" + struct.pack("<I", len(value)) + value
    if isinstance(value, np.int64):
        return b"L" + struct.pack("<q", int(value))
    if isinstance(value, int):
        return b"I" + struct.pack("<i", value)
    return b"D" + struct.pack("<d", value)


def _array(array: Array) -> bytes:
    if array.stored is not None:
        head = struct.pack("<III", array.count, 1, len(array.stored))
        return array.code.encode() + head + array.stored
    types = {"f": "<f4", "d": "<f8", "i": "<i4", "l": "<i8"}
    raw = np.array(array.numbers, dtype=types[array.code]).tobytes()
    stored = zlib.compress(raw) if array.deflate else raw
    head = struct.pack("<III", len(array.numbers), int(array.deflate), len(stored))
    return array.code.encode() + head + stored
