"""Reads audio recordings (WAV, FLAC, OGG, MP3) to mono samples, by libsndfile (soundfile).

Each block is decoded, mixed to mono and decimated before the next one. So a small file that
decompresses to hours needs no more memory and time than MAX_SECONDS. soundfile is in the extra
`audio`.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from app.errors import EmptyFile, ExtraNeeded, TooLarge, UnknownFormat, Unreadable
from app.formats.audio.riff import declared_bytes
from app.kinedex_error import Place
from app.numerics.arrays import FloatArray

FORMATS = "WAV, FLAC, OGG or MP3"
HEAD_BYTES = 12
"""The first bytes of a file, which show its format."""

SAMPLE_RATES = (2000, 400_000)
"""Hz: the smallest and the largest sample rate of a recording."""

MIN_RESULT_RATE = 22_050
"""Hz. In faster recordings neighboring samples are averaged. The result is not below this rate."""

MAX_SECONDS = 1800.0
"""The longest recording."""
MAX_DECLARED_SECONDS = 24 * 3600.0
"""A longer duration in a header means that the program did not know the duration. It is ignored."""
MIN_SHARE = 0.95
"""The smallest share of the declared duration of a complete file. MP3 files only estimate it."""

MAX_CHANNELS = 32
BLOCK_FRAMES = 65_536
"""Samples of each channel that are decoded at once."""


@dataclass(frozen=True, slots=True)
class Sound:
    """A recording as mono samples.

    samples: (n,) float32, full scale 1. rate: Hz of `samples`. format: that of the file. missing: a
    text for people if the file was cut off or damaged; it compares the declared size with the size
    that could be read.
    """

    samples: FloatArray
    rate: float
    format: str
    missing: str | None = None

    @property
    def duration(self) -> float:
        """Seconds."""
        return len(self.samples) / self.rate


def sniff_audio(head: bytes) -> str:
    """The format of a recording by its first HEAD_BYTES: "wav", "flac", "ogg" or "mp3".

    Raises EmptyFile, UnknownFormat.
    """
    if not head:
        raise EmptyFile("The recording is empty.")
    if head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE":
        return "wav"
    for magic, format in ((b"fLaC", "flac"), (b"OggS", "ogg"), (b"ID3", "mp3")):
        if head.startswith(magic):
            return format
    # MPEG audio, layer 3: eleven set bits, no reserved version, layer code 01.
    if len(head) > 1 and head[0] == 0xFF and head[1] & 0xE6 == 0xE2 and head[1] & 0x18 != 0x08:
        return "mp3"
    raise UnknownFormat(f"The recording must be {FORMATS}.")


def read_audio(content: bytes) -> Sound:
    """Decode a recording. If the file was cut off, the part that exists is decoded.

    Raises EmptyFile, UnknownFormat, Unreadable, TooLarge beyond MAX_SECONDS or MAX_CHANNELS, and
    ExtraNeeded if soundfile is not installed.
    """
    format = sniff_audio(content[:HEAD_BYTES])
    soundfile = _library()
    try:
        with soundfile.SoundFile(io.BytesIO(content)) as file:
            _check(file)
            samples, rate = _decode(file)
            missing = _missing(content, file, len(samples) / rate)
    except soundfile.SoundFileError as problem:
        # The other parts of the text name internal steps and addresses in memory.
        message = str(getattr(problem, "error_string", problem)).removeprefix("Error : ")
        raise _unreadable(f"{format.upper()}: {message.rstrip('.')}") from problem
    if not len(samples):
        raise _unreadable("it contains no sound")
    if not np.isfinite(samples).all():
        raise _unreadable("some samples are not numbers")
    return Sound(samples, rate, format, missing)


def _library() -> Any:
    try:
        import soundfile
    except ImportError as missing:
        raise ExtraNeeded.package("soundfile", "Recordings") from missing
    except OSError as missing:  # the wheel without a libsndfile for this machine
        raise ExtraNeeded(f"soundfile cannot load libsndfile: {missing}.") from missing
    return soundfile


def _check(file: Any) -> None:
    """Refuse a sample rate or a number of channels outside the limits, before decoding.

    The duration is checked while decoding, because a header may be wrong.
    """
    if not SAMPLE_RATES[0] <= file.samplerate <= SAMPLE_RATES[1]:
        raise _unreadable(f"a sample rate of {file.samplerate} Hz")
    if file.channels > MAX_CHANNELS:
        message = f"{file.channels} channels, the limit is {MAX_CHANNELS}"
        raise TooLarge(f"The recording has {message}.", places=[Place("audio", message)])


def _decode(file: Any) -> tuple[FloatArray, float]:
    """(n,) float32 mono samples, and their rate in Hz. Raises TooLarge."""
    step = max(1, file.samplerate // MIN_RESULT_RATE)
    rate = file.samplerate / step
    most = int(MAX_SECONDS * rate)
    blocks: list[FloatArray] = []
    count = 0
    while len(block := _next_block(file, step, is_first=not blocks)):
        # (n, channels) -> (n,) -> (n // step,): mean of the channels, then of `step` neighbors
        mono = block.mean(axis=1)
        whole = len(mono) // step * step
        blocks.append(mono[:whole].reshape(-1, step).mean(axis=1))
        count += len(blocks[-1])
        if count > most:
            message = f"longer than {MAX_SECONDS:g} s"
            raise TooLarge(f"The recording is {message}.", places=[Place("audio", message)])
    empty: FloatArray = np.zeros(0, dtype=np.float32)
    return np.concatenate([empty, *blocks]), rate


def _next_block(file: Any, step: int, *, is_first: bool) -> FloatArray:
    """(n, channels) samples. None at the end, or if the decoder fails after the first block."""
    try:
        block = file.read(BLOCK_FRAMES // step * step, dtype="float32", always_2d=True)
    except _library().SoundFileError:
        if is_first:
            raise
        return np.zeros((0, 1), dtype=np.float32)
    return np.asarray(block)


def _missing(content: bytes, file: Any, seconds: float) -> str | None:
    """A text if the header declares more than the `seconds` that were decoded, else None."""
    size = declared_bytes(content)
    if size is not None and size > len(content):
        return f"its header promises {size} bytes, {len(content)} are there"
    declared = file.frames / file.samplerate
    if declared <= MAX_DECLARED_SECONDS and seconds < MIN_SHARE * declared:
        return f"its header promises {declared:.2f} s, {seconds:.2f} s could be decoded"
    return None


def _unreadable(message: str) -> Unreadable:
    return Unreadable(f"The recording cannot be read: {message}.", places=[Place("audio", message)])
