"""Reads the objects of an FBX file, their properties and their connections.

If an object does not have a property, the value of its template is used, and then a default value
of ours. Source: Autodesk's FBX SDK, "FBX object model".
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from app.errors import FormatNotSupported
from app.formats.common.failures import too_large, unreadable_at, unreadable_byte
from app.formats.common.numbers import MAX_MAGNITUDE
from app.formats.fbx.legacy import legacy_scene
from app.formats.fbx.objects import (
    Connection,
    FbxObject,
    Numbers,
    object_name,
    read_properties,
    text_of,
    unsupported_at,
)
from app.formats.fbx.tree import Record, RecordFile
from app.numerics.arrays import FloatArray

MAX_OBJECTS = 500_000
MAX_CONNECTIONS = 1_000_000
MIN_VERSION = 7000
"""Before this version, objects have no ids, and animations are apart from them."""

_KINDS = frozenset(
    ("Model", "NodeAttribute", "AnimationStack", "AnimationLayer", "AnimationCurveNode",
     "AnimationCurve")
)  # fmt: skip
_TIME_DEFINITION = 127
"""The TCDefinition of files in which a second has KTIME ticks."""


@dataclass(slots=True)
class _Ends:
    """The connections of an object: those to it and those from it."""

    incoming: list[Connection] = field(default_factory=list)
    outgoing: list[Connection] = field(default_factory=list)


class FbxScene:
    """Objects by id, their properties and their connections."""

    def __init__(self, file: RecordFile) -> None:
        """Raises Unreadable, FormatNotSupported for encrypted files, TooLarge."""
        _refuse_unsupported_headers(file)
        self._file = file
        self._legacy = legacy_scene(file) if file.version < MIN_VERSION else None
        objects = self._legacy.objects if self._legacy else _objects(file)
        connections = self._legacy.connections if self._legacy else _connections(file)
        self.objects = {one.id: one for one in objects}
        self._ends: dict[int, _Ends] = {}
        for connection in connections:
            self._at(connection.source).outgoing.append(connection)
            self._at(connection.target).incoming.append(connection)
        self._properties: dict[int, dict[str, Numbers]] = {}

    def _at(self, object_id: int) -> _Ends:
        return self._ends.setdefault(object_id, _Ends())

    def of_kind(self, kind: str) -> list[FbxObject]:
        """The objects of a kind, in the order of the file."""
        return [one for one in self.objects.values() if one.kind == kind]

    def sources(self, target: FbxObject, kind: str) -> Iterator[tuple[FbxObject, str]]:
        """The objects of a kind that belong to `target`, each with the property that it drives."""
        for connection in self._at(target.id).incoming:
            source = self.objects.get(connection.source)
            if source is not None and source.kind == kind:
                yield source, connection.to_property

    def targets(self, source: FbxObject, kind: str) -> Iterator[FbxObject]:
        """The objects of a kind to which `source` belongs, without driving a property."""
        for connection in self._at(source.id).outgoing:
            target = self.objects.get(connection.target)
            if target is not None and target.kind == kind and not connection.to_property:
                yield target

    def driven(self, source: FbxObject) -> Iterator[tuple[FbxObject, str]]:
        """The nodes of which `source` drives a property, each with the name of the property."""
        for connection in self._at(source.id).outgoing:
            target = self.objects.get(connection.target)
            if target is not None and target.kind == "Model" and connection.to_property:
                yield target, connection.to_property

    def vector(self, owner: FbxObject, name: str, default: Numbers) -> FloatArray:
        """(n,) float64 the numbers of a property, as many as in `default`. Raises Unreadable."""
        found = self._numbers(owner).get(name) or self._templates.get(owner.kind, {}).get(name)
        found = (found or default)[: len(default)]
        if len(found) != len(default) or not np.all(np.abs(found) <= MAX_MAGNITUDE):
            raise owner.unreadable(f"expected {len(default)} numbers as {name}, found {found}")
        return np.array(found, dtype=np.float64)

    def number(self, owner: FbxObject, name: str, default: float) -> float:
        """A property that is one number. Raises Unreadable."""
        return float(self.vector(owner, name, (default,))[0])

    def ticks(self, owner: FbxObject, name: str) -> float | None:
        """A property that is a time, in ticks; None if the object does not have it."""
        found = self._numbers(owner).get(name)
        return found[0] if found and np.isfinite(found[0]) else None

    def _numbers(self, owner: FbxObject) -> dict[str, Numbers]:
        if owner.id not in self._properties:
            self._properties[owner.id] = read_properties(owner.record)
        return self._properties[owner.id]

    @cached_property
    def settings(self) -> dict[str, Numbers]:
        """The numbers of GlobalSettings."""
        if self._legacy:
            return self._legacy.settings
        found = self._file.top("GlobalSettings")
        return read_properties(found) if found is not None else {}

    @cached_property
    def _templates(self) -> dict[str, dict[str, Numbers]]:
        """The template of each kind of object: the default numbers of its properties."""
        found: dict[str, dict[str, Numbers]] = {}
        definitions = self._file.top("Definitions")
        for record in definitions.children("ObjectType") if definitions else ():
            kind = text_of(next(iter(record.properties(1)), b""))
            template = record.child("PropertyTemplate")
            if kind in _KINDS and template is not None:
                found.setdefault(kind, read_properties(template))
        return found


def _objects(file: RecordFile) -> Iterator[FbxObject]:
    block = file.top("Objects")
    if block is None:
        raise unreadable_at("node Objects", "expected objects, found none")
    count = 0
    for record in block.children():
        if record.name in _KINDS:
            count += 1
            if count > MAX_OBJECTS:
                raise too_large("node Objects", f"expected at most {MAX_OBJECTS}")
            yield _object(record)


def _object(record: Record) -> FbxObject:
    number, name, subtype, *_ = [*record.properties(3), 0, b"", b""]
    if not isinstance(number, int) or isinstance(number, bool) or record.property_count < 3:
        raise unreadable_byte(record.offset, f"expected id, name and type of a {record.name}")
    return FbxObject(number, record.name, object_name(name), text_of(subtype), record)


def _connections(file: RecordFile) -> Iterator[Connection]:
    block = file.top("Connections")
    for count, record in enumerate(block.children("C") if block else ()):
        if count >= MAX_CONNECTIONS:
            raise too_large("node Connections", f"expected at most {MAX_CONNECTIONS}")
        found = record.properties(4)
        if len(found) >= 3 and found[0] in (b"OO", b"OP"):
            _, source, target, to_property, *_ = [*found, b""]
            if not isinstance(source, int) or not isinstance(target, int):
                raise unreadable_byte(record.offset, "expected the ids of two objects")
            yield Connection(source, target, text_of(to_property))


def _refuse_unsupported_headers(file: RecordFile) -> None:
    header = file.top("FBXHeaderExtension")
    encryption = header.child("EncryptionType") if header else None
    if encryption is not None and encryption.properties(1) not in ([], [0]):
        raise FormatNotSupported("This FBX file is encrypted")
    flags = header.child("OtherFlags") if header else None
    definition = flags.child("TCDefinition") if flags else None
    if definition is not None and definition.properties(1) != [_TIME_DEFINITION]:
        raise unsupported_at(
            "node FBXHeaderExtension/OtherFlags", "expected times as FBX 7 counts them"
        )
