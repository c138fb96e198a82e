"""Writes FBX files in text form, and scenes of version 6."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from tests.formats.fbx.files import (
    CONSTANT,
    KTIME,
    LINEAR,
    NEXT,
    Array,
    Bone,
    Curve,
    Curves,
    Letter,
    Record,
)

PARTS = {"Lcl Translation": "T", "Lcl Rotation": "R", "Lcl Scaling": "S"}
Slopes = tuple[float, float]


def text_document(records: Iterable[Record], version: int = 7400) -> bytes:
    """The bytes of a text file. The lists of numbers go over several lines."""
    head = f"; FBX {version / 1000:.1f}.0 project file\n; made for a test\n\n"
    records = list(records)
    first = records[0]
    named = Record(first.name, first.properties, [*first.children, Record("FBXVersion", [version])])
    lines = [line for record in (named, *records[1:]) for line in _lines(record, version, "")]
    return (head + "\n".join(lines) + "\n").encode()


def _lines(record: Record, version: int, indent: str) -> Iterable[str]:
    arrays = [value for value in record.properties if isinstance(value, Array)]
    if arrays:
        numbers = _shown_array(record.name, arrays[0], version)
        yield f"{indent}{record.name}: *{len(numbers)} {{"
        yield f"{indent}\ta: " + f"\n{indent}\t\t,".join(
            ",".join(numbers[at : at + 3]) for at in range(0, max(1, len(numbers)), 3)
        )
        yield f"{indent}}} "
        return
    values = [_shown(value) for value in record.properties]
    joined = ",".join(values[:9]) + "".join(f"\n{indent}  ,{value}" for value in values[9:])
    if not record.children and record.name not in ("Properties70", "Properties60"):
        yield f"{indent}{record.name}: {joined}"
        return
    yield f"{indent}{record.name}: {joined} {{"
    for child in record.children:
        yield from _lines(child, version, indent + "\t")
    yield f"{indent}}}"


def _shown(value: Any) -> str:
    if isinstance(value, Letter):
        return str(value)
    if isinstance(value, bytes):
        name, mark, kind = value.partition(b"\x00\x01")
        text = (kind + b"::" + name if mark else value).decode().replace('"', "&quot;")
        return f'"{text}"'
    return repr(float(value)) if isinstance(value, float) else str(int(value))


def _shown_array(name: str, array: Array, version: int) -> list[str]:
    if name == "KeyAttrDataFloat" and version >= 7200:
        bits = np.array(array.numbers, dtype="<f4").view("<i4")
        return [str(number) for number in bits.tolist()]
    if array.code in "fd":
        return [repr(float(number)) for number in array.numbers]
    return [str(int(number)) for number in array.numbers]


def legacy_scene(
    bones: Sequence[Bone],
    takes: Sequence[tuple[str, Curves]],
    settings: dict[str, Any] | None = None,
    frame_rate: str = "30",
) -> list[Record]:
    """The records of a scene of version 6."""
    objects = [
        Record("Model", [_model(bone.name), bone.subtype.encode()], [_properties(bone.properties)])
        for bone in bones
    ]
    objects.append(Record("GlobalSettings", [], [_properties(settings or {})]))
    links = [
        [b"OO", _model(bone.name), _model("Scene" if bone.parent < 0 else bones[bone.parent].name)]
        for bone in bones
    ]
    rate = Record("Settings", [], [Record("FrameRate", [frame_rate.encode()])])
    return [
        Record("FBXHeaderExtension", [], [Record("FBXHeaderVersion", [1003])]),
        Record("Objects", [], objects),
        Record("Connections", [], [Record("Connect", link) for link in links]),
        Record("Takes", [], [_take(bones, name, curves) for name, curves in takes]),
        Record("Version5", [], [rate]),
    ]


def _model(name: str) -> bytes:
    return name.encode() + b"\x00\x01Model"


def _properties(values: Any) -> Record:
    lines = []
    for name, value in values.items():
        numbers = value if isinstance(value, tuple) else (value,)
        lines.append(Record("Property", [name.encode(), b"", b"A", *numbers]))
    return Record("Properties60", [], lines)


def _take(bones: Sequence[Bone], name: str, curves: Curves) -> Record:
    models = []
    for index, bone in enumerate(bones):
        parts = [
            Record("Channel", [PARTS[to_property].encode()], [
                Record("Channel", [axis.encode()], [
                    Record("Default", [float(curve.values[0])]),
                    Record("KeyVer", [4005]),
                    Record("KeyCount", [len(curve.times)]),
                    Record("Key", _keys(curve)),
                    *curve.extra,
                ])
                for axis, curve in by_axis.items()
            ])
            for (node, to_property), by_axis in curves.items()
            if node == index
        ]  # fmt: skip
        if parts:
            transform = Record("Channel", [b"Transform"], parts)
            models.append(Record("Model", [_model(bone.name)], [transform]))
    return Record("Take", [name.encode()], [Record("FileName", [b"x.tak"]), *models])


def _keys(curve: Curve) -> list[Any]:
    entries: list[Any] = []
    flags = [curve.flags] * len(curve.times) if isinstance(curve.flags, int) else curve.flags
    for index, (second, value) in enumerate(zip(curve.times, curve.values, strict=True)):
        entries += [np.int64(round(second * KTIME)), float(value)]
        flag = flags[index]
        if flag == LINEAR:
            entries.append(Letter("L"))
        elif flag & CONSTANT:
            entries += [Letter("C"), Letter("n" if flag == NEXT else "s")]
        else:
            right, left = (float(n) for n in curve.data[min(index, len(curve.data) - 1)][:2])
            entries += [Letter("U"), Letter("s"), right, left, Letter("n")]
    return entries
