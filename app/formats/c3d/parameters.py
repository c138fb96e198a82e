"""Reads the parameters of a C3D file: named arrays in groups.

Numbers have the format of one of three processors: Intel (little-endian), DEC (little-endian
integers, VAX F floats) or MIPS (big-endian). Source: "The C3D file format user guide" (Motion Lab
Systems 2008), chapters 4 and 5.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod

import numpy as np

from app.errors import Unreadable
from app.formats.common.failures import unreadable_byte
from app.numerics.arrays import FloatArray

BLOCK = 512
"""Bytes of a block. Header, parameters and data begin at whole blocks, counted from 1."""
MAX_RECORDS = 10_000
"""The most groups and parameters that are read. A damaged file may have no end mark."""
_PROCESSORS = {84: "intel", 85: "dec", 86: "mips"}
_VALUE_BYTES = {-1: 1, 1: 1, 2: 2, 4: 4}
"""The bytes of a value for each type of parameter: letters, bytes, 16-bit integers, floats."""


@dataclass(frozen=True, slots=True)
class Numbers:
    """Reads numbers in the format of a processor: "intel", "dec" or "mips"."""

    processor: str

    def integers(self, raw: bytes) -> FloatArray:
        """(n,) float64 the signed 16-bit integers in `raw` (2 n bytes)."""
        kind = ">i2" if self.processor == "mips" else "<i2"
        return np.frombuffer(raw, dtype=kind).astype(np.float64)

    def floats(self, raw: bytes) -> FloatArray:
        """(n,) float32 the 32-bit floats in `raw` (4 n bytes)."""
        if self.processor == "mips":
            return np.frombuffer(raw, dtype=">f4").astype(np.float32)
        if self.processor == "intel":
            return np.frombuffer(raw, dtype="<f4")
        # VAX F is IEEE with the two halves exchanged and an exponent that is two higher.
        halves = np.frombuffer(raw, dtype="<u2").reshape(-1, 2)[:, ::-1]
        with np.errstate(invalid="ignore"):
            return np.ascontiguousarray(halves).view("<f4")[:, 0] / np.float32(4)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter: either numbers, as a flat list, or texts. The other one is empty."""

    values: tuple[float, ...] = ()
    texts: tuple[str, ...] = ()

    @property
    def first(self) -> float | None:
        """The first number; None if there are no numbers."""
        return self.values[0] if self.values else None


Parameters = Mapping[str, Parameter]
"""The parameters by "GROUP:NAME" in upper case."""


def read_parameters(content: bytes) -> tuple[Numbers, Parameters]:
    """The number format of a C3D file, and its parameters.

    content: the file, at least one block. Raises Unreadable with the byte of the damage.
    """
    start = (content[0] - 1) * BLOCK
    if start + 4 > len(content):
        raise unreadable_byte(start, "expected parameters, found the end of the file")
    processor = _PROCESSORS.get(content[start + 3])
    if processor is None:
        found = content[start + 3]
        raise unreadable_byte(start + 3, f"expected processor 84, 85 or 86, found {found}")
    end = start + content[start + 2] * BLOCK
    return Numbers(processor), _Reader(content, start + 4, end, Numbers(processor)).read()


class _Reader:
    """Reads group after group and parameter after parameter, from the byte `at` on.

    end: the end of the section by its number of blocks. Some files have too small a number, so
    records behind it are read too. But some have no end mark, so what is no record there ends the
    section.
    """

    def __init__(self, content: bytes, at: int, end: int, numbers: Numbers) -> None:
        self.content = content
        self.at = at
        self.end = end
        self.numbers = numbers
        self.groups: dict[int, str] = {}
        self.found: list[tuple[int, str, Parameter]] = []

    def read(self) -> Parameters:
        for _ in range(MAX_RECORDS):
            try:
                if not self._record():
                    break
            except Unreadable:
                if self.at < self.end:
                    raise
                break
        # A group may come after its parameters, so names are joined at the end.
        named = ((f"{self.groups.get(g, '')}:{name}", value) for g, name, value in self.found)
        result: dict[str, Parameter] = {}
        for name, value in named:
            result.setdefault(name, value)
        return result

    def _record(self) -> bool:
        """Read a group or a parameter. False at the end of the section.

        The bytes are: length of the name, number of the group (negative for a group itself), the
        name, the offset of the next record from here, and the value.
        """
        if self.at + 2 > len(self.content):
            return False
        length, group = (int(x) for x in np.frombuffer(self.content, "i1", 2, self.at))
        if length == 0 or group == 0:
            return False
        name_at = self.at + 2
        name = self._bytes(name_at, abs(length)).decode("latin-1").strip().upper()
        offset_at = name_at + abs(length)
        offset = int(self.numbers.integers(self._bytes(offset_at, 2))[0])
        if group < 0:
            self.groups[-group] = name
        else:
            self.found.append((group, name, self._parameter(offset_at + 2)))
        if offset < 0:
            raise unreadable_byte(offset_at, f"expected the next parameter, found offset {offset}")
        self.at = offset_at + offset
        return offset > 0

    def _parameter(self, at: int) -> Parameter:
        kind, dimensions = (int(x) for x in np.frombuffer(self._bytes(at, 2), "i1"))
        size = _VALUE_BYTES.get(kind)
        if size is None or not 0 <= dimensions <= 7:
            message = f"expected a parameter, found type {kind} with {dimensions} dimensions: the"
            message += " parameters are damaged from here on; save the file again by the program"
            raise unreadable_byte(at, f"{message} that wrote it, or send TRC")
        shape = list(self._bytes(at + 2, dimensions))
        raw = self._bytes(at + 2 + dimensions, size * prod(shape))
        if kind == -1:
            return Parameter(texts=_texts(raw, shape))
        if kind == 4:
            return Parameter(tuple(self.numbers.floats(raw).tolist()))
        values = self.numbers.integers(raw) if kind == 2 else np.frombuffer(raw, "i1")
        return Parameter(tuple(float(value) for value in values))

    def _bytes(self, start: int, length: int) -> bytes:
        if start + length > len(self.content):
            raise unreadable_byte(start, f"expected {length} bytes, found the end of the file")
        return self.content[start : start + length]


def _texts(raw: bytes, shape: list[int]) -> tuple[str, ...]:
    """The texts in `raw`. The first dimension of `shape` is the length of each."""
    length = shape[0] if shape else len(raw)
    if not length:
        return ()
    pieces = (raw[start : start + length] for start in range(0, len(raw), length))
    return tuple(_text(piece) for piece in pieces)


def _text(raw: bytes) -> str:
    plain = raw.rstrip(b"\x00 ").lstrip()
    try:
        return plain.decode("utf-8")
    except UnicodeDecodeError:
        return plain.decode("latin-1")
