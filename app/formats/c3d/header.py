"""The header of a C3D file, and the size of its frames, also where the header is wrong."""

from __future__ import annotations

from dataclasses import dataclass, replace

from app.formats.c3d.frame_count import declared_counts
from app.formats.c3d.parameters import BLOCK, Numbers, Parameters
from app.formats.common.failures import unreadable_byte
from app.formats.common.numbers import MAX_MAGNITUDE
from app.motion.skeleton.recording import Caution

MIN_SCALE = 1e-12
"""A smaller scale factor counts as 0."""


@dataclass(frozen=True, slots=True)
class Header:
    """The numbers of the header.

    points: of a frame. analog: all analog samples of a frame. first, last: numbers of frames.
    scale: positive for integers, negative for floats. data_block: counted from 1. samples: of a
    channel in a frame. rate: Hz.
    """

    points: int
    analog: int
    first: int
    last: int
    scale: float
    data_block: int
    samples: int
    rate: float

    @property
    def start(self) -> int:
        """The byte at which the data begins."""
        return (self.data_block - 1) * BLOCK

    @property
    def frame_bytes(self) -> int:
        """The bytes of a frame."""
        return (2 if self.scale > 0 else 4) * (4 * self.points + self.analog)


def read_header(content: bytes, numbers: Numbers) -> Header:
    """The header as it is. Raises Unreadable with the byte."""

    def word(index: int) -> int:
        return int(numbers.integers(content[2 * index - 2 : 2 * index])[0]) % 2**16

    def real(index: int) -> float:
        return float(numbers.floats(content[2 * index - 2 : 2 * index + 2])[0])

    scale = real(7)
    if not MIN_SCALE < abs(scale) < MAX_MAGNITUDE:
        raise unreadable_byte(12, f"expected a scale factor, found {scale:g}")
    return Header(word(2), word(3), word(4), word(5), scale, word(9), word(10), real(11))


def with_true_analog(
    header: Header, parameters: Parameters, size: int
) -> tuple[Header, tuple[Caution, ...]]:
    """The header with the number of analog samples that fits the size of the file, in bytes.

    Some programs write the number of channels in place of channels times samples. Then ANALOG:USED
    and the rates give the right number, if the file ends where the frames do.
    """
    count = _analog_of_parameters(header, parameters)
    declared = declared_counts(header.first, header.last, parameters)
    if count is None or count == header.analog or not declared:
        return header, ()
    frames = max(declared)
    other = replace(header, analog=count)
    if _ends_with_frames(header, frames, size) or not _ends_with_frames(other, frames, size):
        return header, ()
    detail = f"the header declares {header.analog} analog samples a frame; {count} were used, which"
    detail += " is channels times samples and fits the size of the file"
    return other, (Caution("header_mismatch", detail),)


def _analog_of_parameters(header: Header, parameters: Parameters) -> int | None:
    """Channels times samples of a frame, by the parameters; None if they do not give it."""
    used, rate, points = (
        parameter.first if (parameter := parameters.get(name)) is not None else None
        for name in ("ANALOG:USED", "ANALOG:RATE", "POINT:RATE")
    )
    if used is None or not 0 <= used < 2**16:
        return None
    samples = header.samples
    if rate and points and 1 <= rate / points <= 2**12:
        samples = round(rate / points)
    return int(used) * max(samples, 1)


def _ends_with_frames(header: Header, frames: int, size: int) -> bool:
    """Whether the file ends in the block in which its last frame ends."""
    spare = size - header.start - frames * header.frame_bytes
    return 0 <= spare < BLOCK
