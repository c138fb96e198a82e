"""The frames of an AMC file: one line for each bone, with the numbers of the bone's channels.

If a frame does not contain a bone, the bone keeps its numbers of the frame before. At first all
channels are zero, which is the rest pose. Sources: as in `asf.py`; the headers
`:SAMPLES-PER-SECOND` and `:RADIANS` as Acclaim's own tools write them.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import Unreadable
from app.formats.acclaim.lines import worded_lines
from app.formats.bvh.frames import FASTEST_RATE, MAX_FRAMES, SLOWEST_RATE
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.numbers import MAX_MAGNITUDE, excerpt
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray

BLOCK_FRAMES = 512
MAX_HELD = 1_000_000
"""Bones times frames that the file does not say: few bytes must not become many numbers."""
SHOWN_BONES = 5
"""As many bones are named in a caution."""

_FRAME = re.compile(rb"\d{1,9}")


@dataclass(frozen=True, slots=True)
class AmcFrames:
    """numbers: (frames, channels) float64 as in the file, bones one after the other;
    numbering: (frames,) the frames' own numbers; lines: (frames,) where they begin;
    frame_rate: Hz or None; in_degrees: None where the file does not say."""

    numbers: FloatArray
    numbering: IntArray
    lines: IntArray
    frame_rate: float | None
    in_degrees: bool | None
    cautions: tuple[Caution, ...]


def read_amc_frames(
    text: bytes, names: Sequence[str], channels: Sequence[tuple[str, ...]]
) -> AmcFrames:
    """Read an AMC file's text, with plain newlines, for bones (joints,) and their channels.

    Raises Unreadable with the line, and TooLarge.
    """
    return _Reader(text, names, channels).read()


@dataclass(slots=True)
class _Frame:
    """One frame while its lines are read: words by channel, lines by bone, bones seen."""

    number: int
    line: int
    words: list[bytes]
    bone_lines: list[int]
    seen: set[int]


class _Reader:
    def __init__(
        self, text: bytes, names: Sequence[str], channels: Sequence[tuple[str, ...]]
    ) -> None:
        self.lines = worded_lines(text)
        self.names = names
        ends = np.cumsum([len(bone) for bone in channels]).tolist()
        self.columns = [
            slice(end - len(bone), end) for end, bone in zip(ends, channels, strict=True)
        ]
        self.bones = {name.lower().encode(): bone for bone, name in enumerate(names)}
        self.expected = {bone for bone, channels_of in enumerate(channels) if channels_of}
        self.width = ends[-1]
        self.has_underscores = b"_" in text
        self.frame_rate: float | None = None
        self.in_degrees: bool | None = None
        self.numbering: list[int] = []
        self.frame_lines: list[int] = []
        self.held = 0
        self.absent: Counter[int] = Counter()
        self.cautions: list[Caution] = []

    def read(self) -> AmcFrames:
        blocks: list[FloatArray] = []
        block: list[_Frame] = []
        for frame in self._frames():
            block.append(frame)
            if len(block) == BLOCK_FRAMES:
                blocks.append(self._parsed(block))
                block = []
            if len(self.numbering) >= MAX_FRAMES:
                raise too_large(f"line {frame.line}", f"expected at most {MAX_FRAMES} frames")
            self.numbering.append(frame.number)
            self.frame_lines.append(frame.line)
        if block:
            blocks.append(self._parsed(block))
        return AmcFrames(
            np.concatenate(blocks),
            np.array(self.numbering),
            np.array(self.frame_lines),
            self.frame_rate,
            self.in_degrees,
            (*self.cautions, *self._absence()),
        )

    def _frames(self) -> Iterator[_Frame]:
        """The frames; a last one that breaks off is left out, with a caution."""
        frame: _Frame | None = None
        fullest = 0
        line = 1
        for line, words in self.lines:
            first = words[0]
            if len(words) == 1 and _FRAME.fullmatch(first):
                if frame is not None:
                    yield self._closed(frame)
                    fullest = max(fullest, len(frame.seen))
                frame = self._opened(frame, int(first), line)
            elif first.startswith(b":"):
                self._header(line, words)
            elif frame is None:
                raise unreadable_line(
                    line, f"expected the number of a frame, found {excerpt(first)}"
                )
            elif not self._bone_line(frame, line, words):
                break
        if frame is None:
            raise unreadable_line(line, "expected frames, found none")
        if self.numbering and len(frame.seen) < fullest:
            detail = f"line {line}: the file breaks off in frame {frame.number}, which is left out"
            self.cautions.append(Caution("truncated", detail))
        else:
            yield self._closed(frame)

    def _header(self, line: int, words: list[bytes]) -> None:
        keyword = words[0][1:].upper()
        if keyword in (b"DEGREES", b"RADIANS"):
            self.in_degrees = keyword == b"DEGREES"
        elif keyword == b"SAMPLES-PER-SECOND":
            self.frame_rate = _rate(words[-1])
            if self.frame_rate is None:
                detail = f"line {line}: expected frames per second, found {excerpt(words[-1])}"
                self.cautions.append(Caution("frame_time_unusable", detail))

    def _opened(self, before: _Frame | None, number: int, line: int) -> _Frame:
        if before is None:
            zeros = [b"0"] * self.width
            return _Frame(number, line, zeros, [line] * len(self.names), set())
        return _Frame(number, line, before.words.copy(), before.bone_lines.copy(), set())

    def _bone_line(self, frame: _Frame, line: int, words: list[bytes]) -> bool:
        """Take in one bone's line; False where the file's last line is cut short."""
        bone = self._bone(words[0], line)
        columns = self.columns[bone]
        found, expected = len(words) - 1, columns.stop - columns.start
        if found != expected:
            if found < expected and self.numbering and next(self.lines, None) is None:
                return False
            name = self.names[bone]
            raise unreadable_line(line, f"expected {expected} numbers for {name}, found {found}")
        if bone in frame.seen:
            raise unreadable_line(
                line, f"expected each bone once a frame, found {self.names[bone]} twice"
            )
        frame.words[columns] = words[1:]
        frame.bone_lines[bone] = line
        frame.seen.add(bone)
        return True

    def _bone(self, name: bytes, line: int) -> int:
        bone = self.bones.get(name)
        if bone is None:
            bone = self.bones.get(name.lower())
            if bone is None:
                raise unreadable_line(
                    line, f"expected a bone of the skeleton, found {excerpt(name)}"
                )
            self.bones[name] = bone
        return bone

    def _closed(self, frame: _Frame) -> _Frame:
        if not self.numbering and 0 not in frame.seen:
            raise unreadable_line(
                frame.line, f"expected the root in frame {frame.number}, found none"
            )
        if len(frame.seen) < len(self.expected):
            self.held += len(self.expected) - len(frame.seen)
            if self.held > MAX_HELD:
                raise too_large(
                    f"line {frame.line}", f"expected at most {MAX_HELD} poses of bones unsaid"
                )
            self.absent.update(self.expected - frame.seen)
        return frame

    def _parsed(self, block: list[_Frame]) -> FloatArray:
        """(frames of the block, channels) float64."""
        try:
            if self.has_underscores and any(b"_" in b"".join(f.words) for f in block):
                raise ValueError  # numpy reads 1_0 as 10
            numbers = np.array([frame.words for frame in block], dtype=np.float64)
        except ValueError:
            raise self._no_number(block) from None
        if numbers.size and not max(numbers.max(), -numbers.min()) <= MAX_MAGNITUDE:
            raise self._no_number(block)
        return numbers.reshape(len(block), self.width)

    def _no_number(self, block: list[_Frame]) -> Unreadable:
        for frame in block:
            for bone, columns in enumerate(self.columns):
                for word in frame.words[columns]:
                    if not _is_usable(word):
                        message = f"expected a number within ±{MAX_MAGNITUDE:g}"
                        line = frame.bone_lines[bone]
                        return unreadable_line(line, f"{message}, found {excerpt(word)}")
        return unreadable_line(block[0].line, "expected numbers")

    def _absence(self) -> Iterator[Caution]:
        always = [bone for bone, count in self.absent.items() if count == len(self.numbering)]
        at_times = [bone for bone in self.absent if bone not in always]
        if always:
            detail = "the motion does not hold these bones, which stay at rest: "
            yield Caution("bones_missing", detail + self._listed(always))
        if at_times:
            detail = "some frames lack these bones, which stay as they were before: "
            yield Caution("bones_missing", detail + self._listed(at_times))

    def _listed(self, bones: list[int]) -> str:
        shown = ", ".join(self.names[bone] for bone in bones[:SHOWN_BONES])
        return shown + (" and others" if len(bones) > SHOWN_BONES else "")


def _is_usable(word: bytes) -> bool:
    try:
        return b"_" not in word and abs(float(word)) <= MAX_MAGNITUDE
    except ValueError:
        return False


def _rate(word: bytes) -> float | None:
    try:
        rate = float(word)
    except ValueError:
        return None
    return rate if SLOWEST_RATE <= rate <= FASTEST_RATE else None
