"""Reads the HIERARCHY part of a BVH file: joints, offsets and channels.

There is no recursion. Joints whose block is open are on a stack, so that any depth can be read.
Source: Meredith and Maddock, "Motion capture file formats explained" (2001). Variants come from
files of many programs.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from app.errors import Unreadable
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.limits import MAX_JOINTS
from app.formats.common.names import readable_name
from app.formats.common.numbers import excerpt, parse_numbers
from app.motion.skeleton.recording import Caution
from app.motion.skeleton.skeleton import Skeleton
from app.numerics.arrays import FloatArray

MAX_CHANNELS = 12
"""The most channels of a joint. Position and rotation need six; some programs repeat channels."""
MAX_HIERARCHY_BYTES = 2_000_000
MAX_CACHED, MAX_CACHED_BYTES = 16, 100_000
"""The most hierarchies in the cache, and the length of the longest one."""

_TOKEN = re.compile(rb"[{}]|[^\s{}]+|\n")
_NUMBERLIKE = re.compile(rb"[-+.,\d]|nan|inf", re.IGNORECASE)
_CHANNEL = re.compile(r"([XYZ])(POSITION|ROTATION)")
_IN_END_SITE = (b"OFFSET", b"CHANNELS", b"}")
_IN_JOINT = (*_IN_END_SITE, b"JOINT", b"END")
_END = 0
"""The mark of an End Site on the stack of open blocks. The mark of a joint is 1 + its index."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One number of a frame: a position or an angle of a joint; axis 0, 1, 2 = X, Y, Z."""

    joint: int
    is_position: bool
    axis: int


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """A skeleton, its channels in the order of the numbers of a frame, and cautions."""

    skeleton: Skeleton
    channels: tuple[Channel, ...]
    cautions: tuple[Caution, ...]


def read_hierarchy(text: bytes) -> Hierarchy:
    """Read the text before MOTION, whose lines are separated by newlines.

    Raises Unreadable with the line, and TooLarge.
    """
    if len(text) > MAX_HIERARCHY_BYTES:
        raise too_large("HIERARCHY", f"expected at most {MAX_HIERARCHY_BYTES} bytes before MOTION")
    return _read_cached(text) if len(text) <= MAX_CACHED_BYTES else _Reader(text).read()


@lru_cache(maxsize=MAX_CACHED)
def _read_cached(text: bytes) -> Hierarchy:
    # All files of one recording session have the same hierarchy, byte for byte.
    hierarchy = _Reader(text).read()
    skeleton = hierarchy.skeleton
    shared = skeleton.parents, skeleton.offsets, skeleton.end_parents, skeleton.end_offsets
    # All clips with this hierarchy share the arrays, so nobody may change them.
    for array in shared:
        array.setflags(write=False)
    return hierarchy


@dataclass(slots=True)
class _Joint:
    name: str
    parent: int
    line: int
    offset: FloatArray | None = None


@dataclass(slots=True)
class _Tokens:
    """The tokens of the text, and the line of the last one. A token can be put back."""

    source: Iterator[re.Match[bytes]]
    line: int = 1
    waiting: list[bytes] = field(default_factory=list)

    def next(self) -> bytes:
        """The next token, or b"" at the end."""
        if self.waiting:
            return self.waiting.pop()
        for match in self.source:
            if match.group() != b"\n":
                return match.group()
            self.line += 1
        return b""

    def until_brace(self) -> list[bytes]:
        """The tokens up to an opening brace, which is consumed."""
        found: list[bytes] = []
        while (token := self.next()) != b"{":
            if token in (b"", b"}"):
                raise self.expected("'{'", token)
            found.append(token)
        return found

    def numbers_on_line(self) -> bytes:
        """The tokens on the rest of this line, up to the first that is not like a number."""
        found: list[bytes] = []
        for match in self.source:
            token = match.group()
            if token == b"\n":
                self.line += 1
                break
            if not _NUMBERLIKE.match(token):
                self.waiting.append(token)
                break
            found.append(token)
        return b" ".join(found)

    def expected(self, what: str, found: bytes) -> Unreadable:
        shown = excerpt(found) if found else "the end of the hierarchy"
        return unreadable_line(self.line, f"expected {what}, found {shown}")


class _Reader:
    """Reads statement after statement. `open` is the stack of open blocks."""

    def __init__(self, text: bytes) -> None:
        self.tokens = _Tokens(_TOKEN.finditer(text))
        self.joints: list[_Joint] = []
        self.channels: list[Channel] = []
        self.ends: list[tuple[int, FloatArray]] = []
        self.open: list[int] = []

    def read(self) -> Hierarchy:
        token = self.tokens.next()
        if token.upper() != b"HIERARCHY":
            raise self.tokens.expected("HIERARCHY", token)
        while token := self.tokens.next():
            self._statement(token)
        if self.open:
            raise self.tokens.expected("'}'", b"")
        if not self.joints:
            raise self.tokens.expected("ROOT", b"")
        return Hierarchy(self._skeleton(), tuple(self.channels), self._cautions())

    def _statement(self, token: bytes) -> None:
        keyword = token.upper().rstrip(b":")
        if keyword not in self._allowed():
            raise self.tokens.expected("a statement of the hierarchy", token)
        if keyword in (b"ROOT", b"JOINT"):
            self._begin_joint()
        elif keyword == b"END":
            self._begin_end_site()
        elif keyword == b"OFFSET":
            self._offset()
        elif keyword == b"CHANNELS":
            self._channels()
        else:
            self._close()

    def _allowed(self) -> tuple[bytes, ...]:
        """The keywords that are allowed here: outside of joints, in an End Site, or in a joint."""
        if not self.open:
            return (b"ROOT",)
        return _IN_END_SITE if self._at_end_site() else _IN_JOINT

    def _at_end_site(self) -> bool:
        return self.open[-1] == _END

    def _begin_end_site(self) -> None:
        self.tokens.until_brace()
        self.open.append(_END)

    def _begin_joint(self) -> None:
        parent = self.open[-1] - 1 if self.open else -1
        line = self.tokens.line
        name = b" ".join(self.tokens.until_brace())
        if len(self.joints) >= MAX_JOINTS:
            raise too_large(f"line {line}", f"expected at most {MAX_JOINTS} joints")
        self.joints.append(_Joint(readable_name(name, line), parent, line))
        self.open.append(len(self.joints))

    def _close(self) -> None:
        opened = self.open.pop()
        if opened != _END and self.joints[opened - 1].offset is None:
            raise self.tokens.expected(f"OFFSET in joint {self.joints[opened - 1].name}", b"}")

    def _offset(self) -> None:
        line = self.tokens.line
        numbers = parse_numbers(self.tokens.numbers_on_line(), line, expected=3)
        if len(numbers) != 3:
            raise unreadable_line(line, f"expected 3 numbers after OFFSET, found {len(numbers)}")
        if self._at_end_site():
            parent = next(opened for opened in reversed(self.open) if opened != _END) - 1
            self.ends.append((parent, numbers))
        else:
            self.joints[self.open[-1] - 1].offset = numbers

    def _channels(self) -> None:
        count = self.tokens.next()
        allowed = 0 if self._at_end_site() else MAX_CHANNELS
        if not re.fullmatch(rb"0*\d{1,2}", count) or int(count) > allowed:
            raise self.tokens.expected(f"a number of channels up to {allowed}", count)
        joint = self.open[-1] - 1
        for _ in range(int(count)):
            channel = self._channel(joint)
            if channel.is_position and channel in self.channels[-MAX_CHANNELS:]:
                raise unreadable_line(self.tokens.line, "expected each position channel once")
            self.channels.append(channel)

    def _channel(self, joint: int) -> Channel:
        token = self.tokens.next()
        match = _CHANNEL.fullmatch(token.decode("ascii", errors="replace").upper().rstrip(","))
        if match is None:
            raise self.tokens.expected("a channel such as Xposition or Zrotation", token)
        return Channel(joint, match.group(2) == "POSITION", "XYZ".index(match.group(1)))

    def _skeleton(self) -> Skeleton:
        offsets = [joint.offset for joint in self.joints if joint.offset is not None]
        return Skeleton(
            names=tuple(joint.name for joint in self.joints),
            parents=np.array([joint.parent for joint in self.joints], dtype=np.int64),
            offsets=np.array(offsets, dtype=np.float64).reshape(-1, 3),
            end_parents=np.array([parent for parent, _ in self.ends], dtype=np.int64),
            end_offsets=np.array([end for _, end in self.ends], dtype=np.float64).reshape(-1, 3),
        )

    def _cautions(self) -> tuple[Caution, ...]:
        counts = Counter(joint.name for joint in self.joints)
        twice = [name for name, count in counts.items() if count > 1]
        if not twice:
            return ()
        shown = ", ".join(twice[:5])
        detail = f"several joints have the same name: {shown}"
        return (Caution("duplicate_names", detail, joint=twice[0]),)
