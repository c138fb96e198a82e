"""The keys of a curve in FBX 6: a list of times, values and letters, one key after another.

After the time and the value of a key comes the way to the next key: C (constant) with s or n (the
value of this key or of the next one), L (linear), or U (cubic) with its tangents. `s` and `b` give
two slopes; other tangents are automatic. Then come weights: n for none, a for both, r and l for one
of them, c for constant ones. The number of weights depends on the version of the keys.

Source: files of Autodesk's SDK and of Blender, compared with what ufbx reads; there is no
specification.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from app.formats.common.failures import unreadable_at
from app.formats.fbx.tree import BuiltRecord, Property, Record
from app.numerics.arrays import FloatArray, IntArray

DEFAULT_KEY_VERSION = 4005
MAX_KEYS = 1_000_000
CONSTANT, NEXT, LINEAR, CUBIC = 0x2, 0x100, 0x4, 0x8
AUTOMATIC, USER = 0x100, 0x400
TIMED, PROGRESSIVE = 0x2000, 0x4000
WEIGHTED_RIGHT, WEIGHTED_NEXT_LEFT = 0x1000000, 0x2000000
WEIGHT_UNIT = 1e-4
"""The unit of the integers in which version 7 stores weights."""
_ARGUMENTS = {"s": 2, "b": 2, "a": 0, "p": 2, "q": 2, "t": 3, "d": 1}
"""The numbers after each kind of tangent."""
_SLOPES = ("s", "b")
_WEIGHTS = {"n": 0, "a": 2, "r": 1, "l": 1, "c": 0}
"""The numbers after each kind of weights."""


@dataclass(slots=True)
class _Key:
    """A key. right, next_left: slopes per second."""

    time: float
    value: float
    flags: int
    right: float = 0.0
    next_left: float = 0.0
    weights: tuple[float, float] = (0.0, 0.0)

    def data(self) -> tuple[float, float, float, float]:
        """The four numbers that version 7 stores. Weights are two integers in the bits of one."""
        right, left = (round(min(max(w, 0.0), 1.0) / WEIGHT_UNIT) for w in self.weights)
        bits = np.array([right | left << 16], dtype=np.uint32).view(np.float32)[0]
        return self.right, self.next_left, bits, 0.0


def curve_record(channel: Record, location: str) -> Record | None:
    """The keys of a channel as a curve of version 7; None without keys. Raises Unreadable."""
    keys = _Keys(channel, location).read()
    if not keys:
        return None
    data = np.zeros((len(keys), 4), dtype=np.float32)
    with np.errstate(over="ignore"):  # numbers that are too large become infinite, and are refused
        values = np.array([key.value for key in keys]).astype(np.float32)
        for row, key in zip(data, keys, strict=True):
            row[:] = key.data()
    arrays: dict[str, FloatArray | IntArray] = {
        "KeyTime": np.array([key.time for key in keys]).astype(np.int64),
        "KeyValueFloat": values,
        "KeyAttrFlags": np.array([key.flags for key in keys], dtype=np.int64),
        "KeyAttrDataFloat": data.ravel(),
        "KeyAttrRefCount": np.ones(len(keys), dtype=np.int64),
    }
    beyond = [child for child in channel.children() if child.name.endswith("-Extrapolation")]
    built = [BuiltRecord(name, channel.offset, numbers=array) for name, array in arrays.items()]
    return BuiltRecord("AnimationCurve", channel.offset, below=[*built, *beyond])


class _Keys:
    """Reads the list of a channel from left to right."""

    def __init__(self, channel: Record, location: str) -> None:
        record = channel.child("Key")
        # A key has at most 13 entries.
        self.entries: Sequence[Property] = record.properties(13 * MAX_KEYS) if record else ()
        self.location = location
        self.at = 0
        self.version = _first_number(channel.child("KeyVer"), DEFAULT_KEY_VERSION)

    def read(self) -> list[_Key]:
        keys: list[_Key] = []
        while self.at < len(self.entries):
            if len(keys) >= MAX_KEYS:
                raise unreadable_at(self.location, f"expected at most {MAX_KEYS} keys")
            time, value = self.number(), self.number()
            if abs(time) > 2**62:
                raise unreadable_at(self.location, "expected times of keys in ticks")
            keys.append(self._key(time, value))
        return keys

    def _key(self, time: float, value: float) -> _Key:
        kind = self.letter("CLU")
        if kind == "L":
            return _Key(time, value, LINEAR)
        if kind == "C":
            is_next = self.version >= 4004 and self.letter("sn") == "n"
            return _Key(time, value, CONSTANT | (NEXT if is_next else 0))
        return self._cubic(time, value)

    def _cubic(self, time: float, value: float) -> _Key:
        tangent = self.letter("".join(_ARGUMENTS))
        numbers = [self.number() for _ in range(_ARGUMENTS[tangent])]
        if tangent in _SLOPES:
            key = _Key(time, value, CUBIC | USER, numbers[0], numbers[1])
        else:
            key = _Key(time, value, CUBIC | AUTOMATIC | TIMED | PROGRESSIVE)
        for _ in range(self._weight_count(tangent)):
            self._weigh(key)
        return key

    def _weight_count(self, tangent: str) -> int:
        if tangent == "t" or (tangent in _SLOPES and self.version == 4003):
            return 0
        if tangent == "a":
            return 0 if self.version <= 4004 else 1
        return 2 if tangent in ("p", "q") and self.version > 4004 else 1

    def _weigh(self, key: _Key) -> None:
        kind = self.letter("".join(_WEIGHTS))
        numbers = [self.number() for _ in range(_WEIGHTS[kind])]
        if kind == "a":
            key.weights = (numbers[0], numbers[1])
            key.flags |= WEIGHTED_RIGHT | WEIGHTED_NEXT_LEFT
        elif kind == "r":
            key.weights = (numbers[0], 0.0)
            key.flags |= WEIGHTED_RIGHT
        elif kind == "l":
            key.weights = (0.0, numbers[0])
            key.flags |= WEIGHTED_NEXT_LEFT

    def number(self) -> float:
        """The next entry, a number."""
        entry = self._next()
        if not isinstance(entry, int | float) or not abs(entry) <= 1e300:
            raise unreadable_at(self.location, f"expected a number in Key, found {entry!r:.40}")
        return entry

    def letter(self, expected: str) -> str:
        """The next entry, one of the letters. Binary files store letters as numbers."""
        entry = self._next()
        if isinstance(entry, bytes):
            found = entry.decode("ascii", "replace")
        else:
            found = chr(entry) if isinstance(entry, int) and 0 < entry < 128 else ""
        if len(found) != 1 or found not in expected:
            message = f"expected one of {', '.join(expected)} in Key, found {entry!r:.40}"
            raise unreadable_at(self.location, message)
        return found

    def _next(self) -> Property:
        if self.at >= len(self.entries):
            raise unreadable_at(self.location, "expected more entries in Key, found the end")
        self.at += 1
        return self.entries[self.at - 1]


def _first_number(record: Record | None, default: float) -> float:
    found = record.properties(1) if record is not None else []
    return float(found[0]) if found and isinstance(found[0], int | float) else default
