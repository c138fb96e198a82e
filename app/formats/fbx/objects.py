"""The objects of an FBX scene, their connections, and the properties of their records."""

from __future__ import annotations

from dataclasses import dataclass

from app.errors import FormatNotSupported, Unreadable
from app.formats.common.failures import unreadable_at
from app.formats.common.names import MAX_NAME_LENGTH
from app.formats.fbx.tree import Record
from app.kinedex_error import Place

Numbers = tuple[float, ...]
_BLOCKS = (("Properties70", "P", 3), ("Properties60", "Property", 2))
"""The block of properties in versions 7 and 6, the record of a property, and the values after its
name that are not its numbers."""


@dataclass(frozen=True, slots=True)
class FbxObject:
    """An object: `kind` is the name of its record, `subtype` is for example LimbNode or Null."""

    id: int
    kind: str
    name: str
    subtype: str
    record: Record

    @property
    def location(self) -> str:
        """The location of the object in the file, for messages."""
        return f"node Objects/{self.kind} {self.id}"

    def unreadable(self, message: str) -> Unreadable:
        """An Unreadable with the location of this object."""
        return unreadable_at(self.location, message)


def unsupported_at(location: str, message: str) -> FormatNotSupported:
    """A FormatNotSupported with the location of a node."""
    return FormatNotSupported(f"{location}: {message}", places=[Place(location, message)])


@dataclass(frozen=True, slots=True)
class Connection:
    """`source` belongs to `target`, or drives a property of it; "" is for no property."""

    source: int
    target: int
    to_property: str = ""


def read_properties(record: Record) -> dict[str, Numbers]:
    """The properties of a record that are numbers, by name."""
    found: dict[str, Numbers] = {}
    for block_name, line_name, skipped in _BLOCKS:
        block = record.child(block_name)
        for line in block.children(line_name) if block is not None else ():
            name, *rest = line.properties() or [b""]
            values = rest[skipped:]
            numbers = tuple(float(n) for n in values if isinstance(n, bool | int | float))
            if numbers:
                found[text_of(name)] = numbers
    return found


def object_name(name: object) -> str:
    """The printable name of an object.

    name: bytes with a name, a separator and a class; in text files `Class::Name`.
    """
    text = name if isinstance(name, bytes) else b""
    if b"\x00\x01" in text:
        text = text.split(b"\x00\x01")[0]
    elif b"::" in text:
        text = text.partition(b"::")[2]
    shown = text[: 4 * MAX_NAME_LENGTH].decode("utf-8", errors="replace")[:MAX_NAME_LENGTH]
    return "".join(char if char.isprintable() else "�" for char in shown)


def text_of(value: object) -> str:
    """The text of a property; empty for other properties."""
    return value.decode("utf-8", errors="replace") if isinstance(value, bytes) else ""
