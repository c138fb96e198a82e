"""Reads the records of an FBX file in text form.

A record is `Name: value, value {children}`. Text is in quotes. A comment begins with a semicolon.
The numbers of an array may continue on the next lines. In version 7 they are in a child named `a`.
Numbers stay bytes until they are asked for, because meshes are the largest part of most files.

Source: files of Autodesk's SDK and of Blender; there is no specification.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np

from app.formats.common.failures import too_large, unreadable_byte
from app.formats.common.numbers import excerpt
from app.formats.fbx.tree import Property, Record
from app.numerics.arrays import FloatArray, IntArray

MAX_TEXT_BYTES = 200_000_000
MAX_RECORDS = 2_000_000
MAX_DEPTH = 64
"""The most levels of records. Files have about eight."""
MIN_BITS_VERSION = 7200
"""From this version on, the attributes of keys are written as the bits of floats."""

_TOKEN = re.compile(
    rb"\s*(?:(?P<comment>;[^\n]*)"
    rb'|"(?P<text>[^"]*)"'
    rb"|(?P<name>[A-Za-z_][\w|. -]{0,100}?)[ \t]*:"
    rb"|(?P<brace>[{}])"
    rb'|(?P<values>[^\s"{};:][^"{};:\n]*)'
    rb"|(?P<end>$))"
)
_VERSION = re.compile(rb"FBXVersion:\s*(\d{1,6})")
_INTEGER = re.compile(rb"[-+]?\d{1,19}")
_INTEGERS = frozenset(("KeyTime", "KeyAttrFlags", "KeyAttrRefCount"))
_FLOATS = frozenset(("KeyValueFloat",))
_BITS = "KeyAttrDataFloat"
_QUOTES = ((b"&quot;", b'"'), (b"&lf;", b"\n"), (b"&cr;", b"\r"))


@dataclass(slots=True)
class TextRecord:
    """A record of a text file. parts: texts in quotes, with True, and lists of other values."""

    name: str
    offset: int
    version: int
    parts: list[tuple[bytes, bool]] = field(default_factory=list)
    below: list[TextRecord] = field(default_factory=list)

    @property
    def property_count(self) -> int:
        """The number of properties, counted up to 16."""
        return len(self.properties())

    def children(self, name: str | None = None) -> Iterator[Record]:
        """The children; only those with a name if one is given."""
        return (child for child in self.below if name is None or child.name == name)

    def child(self, name: str) -> Record | None:
        """The first child of this name."""
        return next(self.children(name), None)

    def properties(self, limit: int = 16) -> list[Property]:
        """The first `limit` properties: text and letters as bytes, integers and floats."""
        found: list[Property] = []
        for part, is_text in self.parts:
            if len(found) >= limit:
                break
            if is_text:
                found.append(_unquoted(part))
            else:
                words = (word.strip() for word in part.split(b","))
                found += [_value(word) for word in words if word]
        return found[:limit]

    def array(self) -> FloatArray | IntArray:
        """(n,) the numbers. Raises Unreadable."""
        inner = next((child for child in self.below if child.name == "a"), self)
        words = [
            word
            for part, is_text in inner.parts
            if not is_text
            for word in part.replace(b",", b" ").split()
            if not word.startswith(b"*")
        ]
        if self.name in _INTEGERS:
            return self._integers(words, np.int64)
        if self.name == _BITS and self.version >= MIN_BITS_VERSION:
            return self._integers(words, np.int32).view(np.float32)
        numbers = self._floats(words)
        with np.errstate(over="ignore"):  # too large numbers become infinite, and are refused
            return numbers.astype(np.float32) if self.name in (*_FLOATS, _BITS) else numbers

    def _integers(self, words: list[bytes], kind: type[np.int64 | np.int32]) -> IntArray:
        try:
            return np.array([int(word) for word in words], dtype=np.int64).astype(kind)
        except (ValueError, OverflowError):
            raise unreadable_byte(self.offset, f"expected integers in {self.name}") from None

    def _floats(self, words: list[bytes]) -> FloatArray:
        try:
            with np.errstate(over="ignore"):
                return np.array(words, dtype=np.float64) if words else np.zeros(0)
        except ValueError:
            raise unreadable_byte(self.offset, f"expected numbers in {self.name}") from None


def _unquoted(text: bytes) -> bytes:
    for name, character in _QUOTES:
        text = text.replace(name, character)
    return text


def _value(word: bytes) -> Property:
    if _INTEGER.fullmatch(word):
        return int(word)
    try:
        return float(word)
    except ValueError:
        return word


class TextFile:
    """An FBX file in text form."""

    def __init__(self, content: bytes) -> None:
        """Parse all records. Raises Unreadable with the byte, and TooLarge."""
        if len(content) > MAX_TEXT_BYTES:
            raise too_large("file", f"expected at most {MAX_TEXT_BYTES} bytes of text")
        if b"\n" not in content:
            content = content.replace(b"\r", b"\n")
        version = _VERSION.search(content, 0, 10_000)
        self.version = int(version.group(1)) if version else 0
        self._records = _parsed(content, self.version)

    def top(self, name: str) -> Record | None:
        """The first record of this name at the top level."""
        return next((record for record in self._records if record.name == name), None)


def _parsed(content: bytes, version: int) -> list[TextRecord]:
    root = TextRecord("", 0, version)
    levels, last, at, count = [root], root, 0, 0
    while at < len(content):
        token = _TOKEN.match(content, at)
        if token is None:
            raise unreadable_byte(at, f"expected a record, found {excerpt(content[at : at + 40])}")
        kind, start = token.lastgroup, token.start()
        if kind == "name":
            count += 1
            if count > MAX_RECORDS:
                raise too_large(f"byte {start}", f"expected at most {MAX_RECORDS} records")
            last = TextRecord(token["name"].decode("ascii", "replace"), start, version)
            levels[-1].below.append(last)
        elif kind in ("text", "values"):
            last.parts.append((token[kind], kind == "text"))
        elif kind == "brace":
            last = _moved(levels, last, token["brace"], start)
        at = token.end()
    return root.below


def _moved(levels: list[TextRecord], last: TextRecord, brace: bytes, at: int) -> TextRecord:
    """Enter the last record, or leave the open one. Returns the record that is open then."""
    if brace == b"{":
        if len(levels) > MAX_DEPTH:
            raise unreadable_byte(at, f"expected at most {MAX_DEPTH} levels of records")
        levels.append(last)
    elif len(levels) > 1:
        levels.pop()
    else:
        raise unreadable_byte(at, "expected a record, found the end of one")
    return levels[-1]
