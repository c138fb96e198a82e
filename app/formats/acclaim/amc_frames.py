"""Reads the frames of an AMC file: one line for each bone, with the numbers of its channels.

If a frame does not contain a bone, the bone keeps its numbers of the frame before. Before the first
frame all channels are zero, which is the rest pose. Sources: see `asf.py`; Acclaim's own tools, for
the headers `:SAMPLES-PER-SECOND` and `:RADIANS`.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from app.errors import Unreadable
from app.formats.acclaim.lines import lines_of_words
from app.formats.bvh.frames import MAX_FRAMES, MAX_RATE, MIN_RATE
from app.formats.common.failures import too_large, unreadable_line
from app.formats.common.numbers import MAX_MAGNITUDE, excerpt
from app.motion.skeleton.recording import Caution
from app.numerics.arrays import FloatArray, IntArray

BLOCK_FRAMES = 512
"""Frames whose words are converted to numbers at once."""
MAX_REPEATED_POSES = 1_000_000
"""The most poses of single bones that are repeated because a frame does not contain the bone. A
small file must not become a large array."""
MAX_BONES_SHOWN = 5
"""The most bones that a caution names."""

_FRAME = re.compile(rb"\d{1,9}")


@dataclass(frozen=True, slots=True)
class AmcFrames:
    """The frames in the order of the file.

    numbers: (frames, channels) float64 as in the file, bone after bone. numbering: (frames,) the
    number that the file gives to each frame. lines: (frames,) the line on which each frame starts.
    frame_rate: Hz, None if the file does not give it. in_degrees: the unit of angles, None if the
    file does not give it.
    """

    numbers: FloatArray
    numbering: IntArray
    lines: IntArray
    frame_rate: float | None
    in_degrees: bool | None
    cautions: tuple[Caution, ...]


def read_amc_frames(
    text: bytes, names: Sequence[str], channels: Sequence[tuple[str, ...]]
) -> AmcFrames:
    """Read the text of an AMC file, which has plain newlines.

    names, channels: (joints,) the bones of the skeleton, and the channels of each bone. Raises
    Unreadable with the line, and TooLarge.
    """
    return _Reader(text, names, channels).read()


@dataclass(slots=True)
class _Frame:
    """A frame while its lines are read.

    words: the number of each channel as text. bone_lines: for each bone, the line of its numbers.
    seen: the bones that the frame contains.
    """

    number: int
    line: int
    words: list[bytes]
    bone_lines: list[int]
    seen: set[int]


class _Reader:
    """Reads the lines once, from the first to the last, and collects the frames."""

    def __init__(
        self, text: bytes, names: Sequence[str], channels: Sequence[tuple[str, ...]]
    ) -> None:
        self.lines = lines_of_words(text)
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
        self.repeated_poses = 0
        self.absent: Counter[int] = Counter()
        self.cautions: list[Caution] = []

    def read(self) -> AmcFrames:
        blocks: list[FloatArray] = []
        block: list[_Frame] = []
        for frame in self._frames():
            block.append(frame)
            if len(block) == BLOCK_FRAMES:
                blocks.append(self._numbers(block))
                block = []
            if len(self.numbering) >= MAX_FRAMES:
                raise too_large(f"line {frame.line}", f"expected at most {MAX_FRAMES} frames")
            self.numbering.append(frame.number)
            self.frame_lines.append(frame.line)
        if block:
            blocks.append(self._numbers(block))
        return AmcFrames(
            np.concatenate(blocks),
            np.array(self.numbering),
            np.array(self.frame_lines),
            self.frame_rate,
            self.in_degrees,
            (*self.cautions, *self._absent_bones()),
        )

    def _frames(self) -> Iterator[_Frame]:
        """The frames. If the last frame is incomplete, it is left out, with a caution."""
        frame: _Frame | None = None
        fullest = 0
        line = 1
        for line, words in self.lines:
            first = words[0]
            if len(words) == 1 and _FRAME.fullmatch(first):
                if frame is not None:
                    yield self._checked(frame)
                    fullest = max(fullest, len(frame.seen))
                frame = self._next_frame(frame, int(first), line)
            elif first.startswith(b":"):
                self._read_header(line, words)
            elif frame is None:
                raise unreadable_line(
                    line, f"expected the number of a frame, found {excerpt(first)}"
                )
            elif not self._read_bone(frame, line, words):
                break
        if frame is None:
            raise unreadable_line(line, "expected frames, found none")
        # A file that was cut off often ends in the middle of a frame.
        if self.numbering and len(frame.seen) < fullest:
            detail = f"line {line}: the file breaks off in frame {frame.number}, which is left out"
            self.cautions.append(Caution("truncated", detail))
        else:
            yield self._checked(frame)

    def _read_header(self, line: int, words: list[bytes]) -> None:
        keyword = words[0][1:].upper()
        if keyword in (b"DEGREES", b"RADIANS"):
            self.in_degrees = keyword == b"DEGREES"
        elif keyword == b"SAMPLES-PER-SECOND":
            self.frame_rate = _rate(words[-1])
            if self.frame_rate is None:
                detail = f"line {line}: expected frames per second, found {excerpt(words[-1])}"
                self.cautions.append(Caution("frame_time_unusable", detail))

    def _next_frame(self, before: _Frame | None, number: int, line: int) -> _Frame:
        if before is None:
            zeros = [b"0"] * self.width
            return _Frame(number, line, zeros, [line] * len(self.names), set())
        return _Frame(number, line, before.words.copy(), before.bone_lines.copy(), set())

    def _read_bone(self, frame: _Frame, line: int, words: list[bytes]) -> bool:
        """Add the line of a bone to its frame; False if it is the last line and is cut short."""
        if self._is_cut_name(words):
            return False
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

    def _is_cut_name(self, words: list[bytes]) -> bool:
        """Whether the last line of the file is the beginning of a bone's name."""
        name = words[0].lower()
        if len(words) > 1 or not self.numbering or name in self.bones:
            return False
        is_cut = any(bone.startswith(name) for bone in self.bones)
        return is_cut and next(self.lines, None) is None

    def _bone(self, name: bytes, line: int) -> int:
        bone = self.bones.get(name)
        if bone is None:
            bone = self.bones.get(name.lower())
            if bone is None:
                raise unreadable_line(
                    line, f"expected a bone of the skeleton, found {excerpt(name)}"
                )
            # The spelling is remembered, so that the other frames find the bone at once.
            self.bones[name] = bone
        return bone

    def _checked(self, frame: _Frame) -> _Frame:
        if not self.numbering and 0 not in frame.seen:
            raise unreadable_line(
                frame.line, f"expected the root in frame {frame.number}, found none"
            )
        if len(frame.seen) < len(self.expected):
            self.repeated_poses += len(self.expected) - len(frame.seen)
            if self.repeated_poses > MAX_REPEATED_POSES:
                message = f"expected at most {MAX_REPEATED_POSES} bones that frames do not contain"
                raise too_large(f"line {frame.line}", message)
            self.absent.update(self.expected - frame.seen)
        return frame

    def _numbers(self, block: list[_Frame]) -> FloatArray:
        """(frames of the block, channels) float64."""
        try:
            if self.has_underscores and any(b"_" in b"".join(f.words) for f in block):
                raise ValueError  # numpy reads 1_0 as 10
            numbers = np.array([frame.words for frame in block], dtype=np.float64)
        except ValueError:
            raise self._bad_number(block) from None
        # The comparison is also false for NaN.
        if numbers.size and not max(numbers.max(), -numbers.min()) <= MAX_MAGNITUDE:
            raise self._bad_number(block)
        return numbers.reshape(len(block), self.width)

    def _bad_number(self, block: list[_Frame]) -> Unreadable:
        for frame in block:
            for bone, columns in enumerate(self.columns):
                for word in frame.words[columns]:
                    if not _is_usable(word):
                        message = f"expected a number within ±{MAX_MAGNITUDE:g}"
                        line = frame.bone_lines[bone]
                        return unreadable_line(line, f"{message}, found {excerpt(word)}")
        return unreadable_line(block[0].line, "expected numbers")

    def _absent_bones(self) -> Iterator[Caution]:
        always = [bone for bone, count in self.absent.items() if count == len(self.numbering)]
        at_times = [bone for bone in self.absent if bone not in always]
        if always:
            detail = "the motion does not contain these bones, which stay at rest: "
            yield Caution(
                "bones_missing", detail + self._listed(always), joint=self.names[always[0]]
            )
        if at_times:
            detail = "some frames do not contain these bones, which keep their pose: "
            yield Caution(
                "bones_missing", detail + self._listed(at_times), joint=self.names[at_times[0]]
            )

    def _listed(self, bones: list[int]) -> str:
        shown = ", ".join(self.names[bone] for bone in bones[:MAX_BONES_SHOWN])
        return shown + (" and others" if len(bones) > MAX_BONES_SHOWN else "")


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
    return rate if MIN_RATE <= rate <= MAX_RATE else None
