"""The scene of an FBX 6 file as objects and connections of version 7.

In version 6, objects have names instead of ids, the settings are among the objects, and the takes
have the channels of models: Transform / T, R, S / X, Y, Z.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from app.formats.common.failures import too_large, unreadable_at
from app.formats.fbx.legacy_keys import curve_record
from app.formats.fbx.objects import Connection, FbxObject, Numbers, object_name, read_properties
from app.formats.fbx.objects import text_of as text
from app.formats.fbx.tree import BuiltRecord, Record, RecordFile

MAX_OBJECTS = 500_000
_PROPERTIES = {"T": "Lcl Translation", "R": "Lcl Rotation", "S": "Lcl Scaling"}
_AXES = "XYZ"
_CUSTOM_MODE = 14.0


@dataclass(slots=True)
class LegacyScene:
    """The objects, their connections, and the numbers of GlobalSettings."""

    objects: list[FbxObject] = field(default_factory=list)
    connections: list[Connection] = field(default_factory=list)
    settings: dict[str, Numbers] = field(default_factory=dict)

    def add(self, kind: str, name: str, record: Record, subtype: str = "") -> int:
        """Add an object and return its id. Raises TooLarge."""
        if len(self.objects) >= MAX_OBJECTS:
            raise too_large("node Objects", f"expected at most {MAX_OBJECTS}")
        number = len(self.objects) + 1
        self.objects.append(FbxObject(number, kind, name, subtype, record))
        return number


def legacy_scene(file: RecordFile) -> LegacyScene:
    """The scene of a file of version 6. Raises Unreadable, TooLarge."""
    block = file.top("Objects")
    if block is None:
        raise unreadable_at("node Objects", "expected objects, found none")
    scene = LegacyScene(settings=_settings(file, block))
    by_name = _add_models(scene, block)
    connections = file.top("Connections")
    for record in connections.children("Connect") if connections else ():
        kind, source, target, *_ = [*record.properties(3), b"", b"", b""]
        if kind == b"OO" and source in by_name and target in by_name:
            scene.connections.append(Connection(by_name[source], by_name[target]))
    takes = file.top("Takes")
    for take in takes.children("Take") if takes else ():
        _add_take(scene, take, by_name)
    return scene


def _settings(file: RecordFile, block: Record) -> dict[str, Numbers]:
    """The numbers of GlobalSettings; the rate of Version5 if they give none."""
    record = block.child("GlobalSettings") or file.top("GlobalSettings")
    found = read_properties(record) if record is not None else {}
    version5 = file.top("Version5")
    settings = version5.child("Settings") if version5 else None
    rate = settings.child("FrameRate") if settings else None
    shown = text(next(iter(rate.properties(1)), b"")) if rate else ""
    if "TimeMode" not in found and shown.replace(".", "", 1).isdecimal():
        found |= {"TimeMode": (_CUSTOM_MODE,), "CustomFrameRate": (float(shown),)}
    return found


def _add_models(scene: LegacyScene, block: Record) -> dict[object, int]:
    """Add the models. Returns the id of each by its full name."""
    by_name: dict[object, int] = {}
    for record in block.children("Model"):
        name, subtype, *_ = [*record.properties(2), b"", b""]
        number = scene.add("Model", object_name(name), record, text(subtype))
        by_name.setdefault(name, number)
    return by_name


def _add_take(scene: LegacyScene, take: Record, by_name: dict[object, int]) -> None:
    name = text(next(iter(take.properties(1)), b""))
    stack = scene.add("AnimationStack", name, _span(take))
    layer = scene.add("AnimationLayer", name, BuiltRecord("AnimationLayer", take.offset))
    scene.connections.append(Connection(layer, stack))
    for model in take.children("Model"):
        target = by_name.get(next(iter(model.properties(1)), b""))
        for channel in _channels(model, "Transform") if target else ():
            for letter, to_property in _PROPERTIES.items():
                for part in _channels(channel, letter):
                    _add_curves(scene, part, layer, target or 0, to_property)


def _span(take: Record) -> Record:
    """A record with the times of the take as properties of version 7."""
    local = take.child("LocalTime")
    times = local.properties(2) if local else []
    lines = [
        BuiltRecord("P", take.offset, [name.encode(), b"", b"", b"", time])
        for name, time in zip(("LocalStart", "LocalStop"), times, strict=False)
    ]
    return BuiltRecord(
        "AnimationStack", take.offset, below=[BuiltRecord("Properties70", take.offset, below=lines)]
    )


def _channels(record: Record, name: str) -> Iterator[Record]:
    """The channels of a record that have a name."""
    for channel in record.children("Channel"):
        if text(next(iter(channel.properties(1)), b"")) == name:
            yield channel


def _add_curves(
    scene: LegacyScene, part: Record, layer: int, target: int, to_property: str
) -> None:
    """Add a curve node that drives a property of a model, and its curves."""
    location = f"node Takes, byte {part.offset}"
    lines, curves = [], []
    for axis in _AXES:
        for channel in _channels(part, axis):
            default = channel.child("Default")
            for value in default.properties(1) if default else ():
                values = [f"d|{axis}".encode(), b"", b"", b"", value]
                lines.append(BuiltRecord("P", part.offset, values))
            curve = curve_record(channel, location)
            if curve is not None:
                curves.append((f"d|{axis}", curve))
    block = BuiltRecord("Properties70", part.offset, below=lines)
    record = BuiltRecord("AnimationCurveNode", part.offset, below=[block])
    node = scene.add("AnimationCurveNode", to_property, record)
    scene.connections.append(Connection(node, layer))
    scene.connections.append(Connection(node, target, to_property))
    for name, curve in curves:
        number = scene.add("AnimationCurve", "", curve)
        scene.connections.append(Connection(number, node, name))
